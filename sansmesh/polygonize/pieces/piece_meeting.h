// Points where one, two or three pieces of a field vanish together: on a smooth part, a crease or a corner.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "sansmesh/field/piecewise_field.h"

namespace sansmesh::inline v1 {

/// A small set of pieces, in ascending order.
struct PieceSet {
  static constexpr std::size_t kMost = 6;
  std::uint32_t count = 0;
  std::array<std::uint32_t, kMost> piece{};

  PieceSet() = default;
  PieceSet(std::initializer_list<std::uint32_t> pieces) {
    for (const std::uint32_t p : pieces) add(p);
  }
  const std::uint32_t* begin() const { return piece.data(); }
  const std::uint32_t* end() const { return piece.data() + count; }
  bool has(std::uint32_t p) const;
  /// Whether the piece is in the set afterwards; false if the set is full.
  bool add(std::uint32_t p);
};

PieceSet common(const PieceSet& a, const PieceSet& b);

/// Value and gradient of one piece at one point.
struct PieceValue {
  std::uint32_t piece = 0;
  Vec3 x;
  double value = 0;
  Vec3 gradient;
};

/// Computes value and gradient of all entries, with one call of the field per distinct piece.
void evaluate_pieces(const PiecewiseField& field, std::span<PieceValue> all);

/// Search for a point where one, two or three pieces vanish.
struct Meeting {
  // Input.
  Vec3 start;
  double reach = 0;  ///< largest accepted distance from `start`
  std::array<std::uint32_t, 3> piece{};
  std::uint32_t count = 0;
  // Result.
  bool found = false;
  Vec3 x;
  std::array<Vec3, 3> normal;  ///< unit normals of the pieces at x
};

/// Sine of the angle below which two pieces count as tangent (2°): they form no crease, and none could be placed
/// exactly.
constexpr double kTangentSine = 0.035;

/// Smallest determinant of three unit normals that define a corner.
constexpr double kFlatCorner = 0.02;

/// Newton's method on all pieces of each search at once, with minimum-norm steps, so that the result is approximately
/// the point nearest to `start`. Not found: where pieces are tangent (kTangentSine; three pieces: kFlatCorner), beyond
/// `reach`, and where the field itself does not vanish.
void find_meetings(const PiecewiseField& field, std::span<Meeting> all);

}  // namespace sansmesh::inline v1
