// Fields that are smooth but for creases: the interface between constructive geometry, which makes them, and
// polygonisation, which puts vertices on their creases.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>

#include "sansmesh/scalar_field.h"

namespace sansmesh::inline v1 {

/// What is known of a field around a point: how large blocks of a mesh may be there.
struct Surroundings {
  /// Radius of a ball around the point within which the field is one piece: of no use beyond SurveyReach::alone, 0
  /// where nothing is known.
  double alone = 0;
  /// Edge of blocks that resolve the piece: 0 where that is not known, infinity where the piece is a formula without
  /// any detail that values and gradients at a few points would miss.
  double detail = 0;
};

/// How far around a point a survey looks (lengths).
struct SurveyReach {
  double detail = 0;  ///< for details
  double alone = 0;   ///< for other pieces
};

class PieceExpression;

/// At every point the value is that of one of several smooth functions, its pieces (combined by minima, maxima and
/// changes of sign). Two pieces meet in a crease of the zero set where both vanish, three in a corner. All that is
/// asked of many points spreads them over threads itself, as evaluate() does.
class PiecewiseField : public ScalarField {
 public:
  /// Number of pieces, numbered from 0.
  virtual std::uint32_t pieces() const = 0;

  /// Which piece is the field at each of x. As many entries as x. Safe from several threads.
  virtual void active(std::span<const Vec3> x, std::span<std::uint32_t> piece) const = 0;

  /// One piece at all of x, wherever it is active, with the sign that it has in the field; `gradients` may be empty.
  /// Safe from several threads.
  virtual void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                              std::span<Vec3> gradients) const = 0;

  /// A bound for the norm of the gradients, if there is one that is known. Where there is none, ranges() says how the
  /// values change.
  virtual std::optional<double> slope_bound() const { return std::nullopt; }

  /// Thickness of the thinnest part or hole that is known, infinity if there is none.
  virtual double thickness() const { return std::numeric_limits<double>::infinity(); }

  /// The field as minima and maxima of its pieces (piece_expression.h), where it is nothing else; else nothing. Where
  /// surfaces coincide but for rounding, parts of a union overlap, by the length `tie`, and what is subtracted goes
  /// through: `tie` should be far above the rounding of values, and below that of the mesh.
  virtual std::shared_ptr<const PieceExpression> expression([[maybe_unused]] double tie) const { return nullptr; }

  /// Values, and what is known around each of x. As many entries as x. Safe from several threads. Nothing is known
  /// unless this is overridden.
  virtual void survey(std::span<const Vec3> x, [[maybe_unused]] const SurveyReach& reach, std::span<double> values,
                      std::span<Surroundings> around) const {
    evaluate(x, values);
    std::fill(around.begin(), around.end(), Surroundings{});
  }

  /// From the slope, if that is known.
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override {
    detail::ranges_by_slope(*this, slope_bound().value_or(kAssumedSlope), x, radius, found);
  }
};

}  // namespace sansmesh::inline v1
