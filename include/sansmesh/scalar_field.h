// A field that can be evaluated anywhere: the one interface between methods (which make fields from samples) and
// consumers (polygonisers, renderers, evaluators), none of which knows the other.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// What values lie between, both ends included.
struct ValueRange {
  double least, most;
  bool holds_zero() const { return least <= 0 && most >= 0; }
};

/// Fields that know nothing of their slopes are taken to be no steeper than this. It is not known.
constexpr double kAssumedSlope = 1.5;

/// A scalar function on space. Implicit surfaces are negative inside, positive outside, and near their zero set
/// measured in units of length (the gradient has norm about 1).
///
/// Who runs in parallel: the field does. Whoever asks hands over all points that it has, and makes no loop for the sake
/// of threads; the field spreads a large batch over the threads of its caller (parallel_ranges of core/parallel.h,
/// which runs a batch of one range where it is asked), or hands it on to fields that do. It may be asked inside a loop
/// all the same, there with a batch for each iteration. The same holds for all that is asked of many points in this
/// folder: Projection, PiecewiseField, NormalField, ColorField.
class SANSMESH_API ScalarField {
 public:
  virtual ~ScalarField() = default;

  /// Where the field is defined; outside it evaluate() still returns finite values.
  virtual Box3 bounds() const = 0;

  /// Values, and if `gradients` is not empty gradients, at all of x. One call per batch: neighbouring points in
  /// neighbouring slots evaluate fastest. Sizes must agree (gradients may be empty). Safe from several threads.
  virtual void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const = 0;

  /// The same, and which of x lie in the domain of definition (1; elsewhere 0): only there does a change of sign mean a
  /// surface. A field that is defined everywhere need not override this.
  virtual void evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                                  std::span<std::uint8_t> inside) const {
    evaluate(x, values, gradients);
    std::fill(inside.begin(), inside.end(), std::uint8_t{1});
  }

  /// What all values within `radius` (>= 0) of each of x lie between: where that does not hold 0, no surface is so
  /// near. As many entries as x; infinite ends where nothing is known. Fields that do not override this (fields of
  /// samples, of callers) are taken to be no steeper than kAssumedSlope; the others say what they take for
  /// granted. Safe from several threads.
  virtual void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const;
};

namespace detail {
/// ScalarField::ranges of a field whose gradients are no longer than `slope`.
SANSMESH_API void ranges_by_slope(const ScalarField& field, double slope, std::span<const Vec3> x, double radius,
                                  std::span<ValueRange> found);
/// Puts the answers of another field where `inside` is 0. Sizes must agree (gradients may be empty).
SANSMESH_API void fill_undefined(const ScalarField& other, std::span<const Vec3> x,
                                 std::span<const std::uint8_t> inside, std::span<double> values,
                                 std::span<Vec3> gradients);
}  // namespace detail

/// A field at one place, and the principal curvatures of its level set there: 1 / length, positive where the set
/// {F <= F(x)} is convex, k1 >= k2; both 0 where the gradient vanishes.
struct LevelSetPoint {
  double value = 0;
  Vec3 gradient;
  double k1 = 0, k2 = 0;
  double mean_curvature() const { return 0.5 * (k1 + k2); }
  double gaussian_curvature() const { return k1 * k2; }
};

}  // namespace sansmesh::inline v1
