// Piecewise smooth fields with creases: the interface between constructive solid geometry, which produces them, and
// polygonisation, which puts vertices on creases.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

#include "sansmesh/scalar_field.h"

namespace sansmesh::inline v1 {

/// Local properties of a field that bound the block size of a mesh.
struct Surroundings {
  /// Radius of a ball around the point in which the field is one piece; used up to SurveyReach::alone, 0 if unknown.
  double alone = 0;
  /// Edge length of blocks that resolve the piece: 0 if unknown, infinite if the piece is a formula without details
  /// that values and gradients at a few points would miss.
  double detail = 0;
};

/// Radii of a survey around a point (lengths).
struct SurveyReach {
  double detail = 0;  ///< radius for details
  double alone = 0;   ///< radius for other pieces
};

class PieceExpression;

/// Field whose value at every point is that of one of several smooth functions, its pieces (combined by minima, maxima
/// and changes of sign). Two pieces meet in a crease of the zero set where both vanish, three in a corner. All batch
/// functions distribute points over threads, as evaluate() does.
class PiecewiseField : public ScalarField {
 public:
  /// Number of pieces, numbered from 0.
  virtual std::uint32_t pieces() const = 0;

  /// Writes the active piece at each of x. As many entries as x. Thread-safe.
  virtual void active(std::span<const Vec3> x, std::span<std::uint32_t> piece) const = 0;

  /// Evaluates one piece at all of x, active or not, with its sign in the field; `gradients` may be empty. Thread-safe.
  virtual void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                              std::span<Vec3> gradients) const = 0;

  /// Known bound for the gradient norm, if any. Without one, ranges() bounds the change of values.
  virtual std::optional<double> slope_bound() const { return std::nullopt; }

  /// Known thickness of the thinnest part or hole; infinite if there is none.
  virtual double thickness() const { return std::numeric_limits<double>::infinity(); }

  /// Expression of minima and maxima that equals the field (piece_expression.h), if there is one; otherwise null. Where
  /// surfaces coincide up to rounding, parts of a union overlap by the length `tie`, and subtracted parts cut through:
  /// `tie` should be far above the rounding errors of values and below the resolution of the mesh.
  virtual std::shared_ptr<const PieceExpression> expression([[maybe_unused]] double tie) const { return nullptr; }

  /// Evaluates values and local properties at each of x. As many entries as x. Thread-safe. The default knows no
  /// properties.
  virtual void survey(std::span<const Vec3> x, [[maybe_unused]] const SurveyReach& reach, std::span<double> values,
                      std::span<Surroundings> around) const {
    evaluate(x, values);
    std::fill(around.begin(), around.end(), Surroundings{});
  }

  /// Uses the slope bound, if known.
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override {
    detail::ranges_by_slope(*this, slope_bound().value_or(kAssumedSlope), x, radius, found);
  }
};

}  // namespace sansmesh::inline v1
