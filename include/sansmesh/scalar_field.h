// Scalar field on space: the interface between methods, which construct fields from samples, and consumers
// (polygonisers, renderers, evaluators).
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/query.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Closed interval of values.
struct ValueRange {
  double least = 0;  ///< lower end, may be −infinity
  double most = 0;   ///< upper end, may be infinity
  /// Whether the interval contains 0, so that a surface is possible.
  bool holds_zero() const { return least <= 0 && most >= 0; }
};

/// Assumed bound of the gradient norm for fields without a known bound.
constexpr double kAssumedSlope = 1.5;

/// Scalar function on space. Implicit surfaces are negative inside and positive outside; near their zero set they
/// approximate the distance (the gradient norm is about 1).
///
/// Parallelism is the field's task. Callers pass all their points in one call instead of looping in parallel; the field
/// distributes a large batch over the threads of its caller (sansmesh/threads.h), or passes it to fields that do. Calls
/// from within a parallel loop are allowed, with a batch per iteration. The same holds for VectorField, VolumeField and
/// SpaceMap.
class SANSMESH_API ScalarField {
 public:
  /// Allows ownership through a ScalarField pointer.
  virtual ~ScalarField() = default;

  /// Domain of the field; outside it, evaluate() still returns finite values.
  virtual Box3 bounds() const = 0;

  /// Evaluates values and, unless `gradients` is empty, gradients at all of x. One call per batch, fastest if
  /// neighbouring points are adjacent. Sizes must agree. Thread-safe.
  virtual void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const = 0;

  /// Same, and sets `inside` to 1 for points in the domain and to 0 elsewhere: only there does a change of sign mean a
  /// surface. The default is for fields defined everywhere.
  virtual void evaluate_in_domain(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients,
                                  std::span<std::uint8_t> inside) const {
    evaluate(x, values, gradients);
    std::fill(inside.begin(), inside.end(), std::uint8_t{1});
  }

  /// Both functions through the common interface of fields. Throws ArgumentError if sizes differ.
  void query(const QueryPoints& at, const ScalarFieldValues& wanted) const;

  /// Bounds the values within `radius` (>= 0) of each of x: if the interval does not contain 0, no surface is within
  /// this distance. As many entries as x; infinite ends if nothing is known. The default (for fields of samples or of
  /// callers) assumes gradients of at most kAssumedSlope; overriding fields document their assumptions. Thread-safe.
  virtual void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const;
};

namespace detail {
/// ScalarField::ranges of a field whose gradient norm is at most `slope`.
SANSMESH_API void ranges_by_slope(const ScalarField& field, double slope, std::span<const Vec3> x, double radius,
                                  std::span<ValueRange> found);
/// Replaces values and gradients by those of another field where `inside` is 0. Sizes must agree (gradients may be
/// empty).
SANSMESH_API void fill_undefined(const ScalarField& other, std::span<const Vec3> x,
                                 std::span<const std::uint8_t> inside, std::span<double> values,
                                 std::span<Vec3> gradients);
}  // namespace detail

/// Field value at a point and principal curvatures of its level set there: 1 / length, positive if the set {F <= F(x)}
/// is convex, k1 >= k2; both 0 if the gradient vanishes.
struct LevelSetPoint {
  double value = 0;  ///< field value
  Vec3 gradient;     ///< field gradient: value per length
  double k1 = 0;     ///< larger principal curvature (1 / length)
  double k2 = 0;     ///< smaller principal curvature (1 / length)
  /// Mean curvature (k1 + k2) / 2 (1 / length).
  double mean_curvature() const { return 0.5 * (k1 + k2); }
  /// Gaussian curvature k1 k2 (1 / length²).
  double gaussian_curvature() const { return k1 * k2; }
};

/// Principal curvatures at a surface point. Curvatures in 1 / length, *positive where the surface is convex* (curves
/// away from the outward normal): +1/r on a sphere of radius r.
struct PrincipalCurvatures {
  float k1 = 0;          ///< the larger one
  float k2 = 0;          ///< the smaller one
  Vec3f direction1;      ///< direction of k1: unit, tangential, up to sign
  Vec3f direction2;      ///< direction of k2: unit, tangential, orthogonal to direction1, up to sign
  bool defined = false;  ///< false: too few or degenerate neighbours, no normal, or no field; then all is zero
};

/// (k1 + k2) / 2 (1 / length).
inline float mean_curvature(const PrincipalCurvatures& c) { return 0.5f * (c.k1 + c.k2); }

/// k1 k2 (1 / length²).
inline float gaussian_curvature(const PrincipalCurvatures& c) { return c.k1 * c.k2; }

}  // namespace sansmesh::inline v1
