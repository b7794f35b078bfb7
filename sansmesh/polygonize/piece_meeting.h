// Points where pieces of a field vanish together: on one piece of the surface, on a crease, in a corner.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/field/piecewise_field.h"

namespace sansmesh::inline v1 {

/// A few pieces, in ascending order.
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
  /// Whether it is in the set afterwards: not if there is no room.
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

/// Fills in value and gradient of all, one call of the field for each piece among them.
void evaluate_pieces(const PiecewiseField& field, std::span<PieceValue> all);

/// The search for a point where one, two or three pieces vanish.
struct Meeting {
  // What is looked for:
  Vec3 start;
  double reach = 0;  ///< how far from `start` it may be
  std::array<std::uint32_t, 3> piece{};
  std::uint32_t count = 0;
  // What was found:
  bool found = false;
  Vec3 x;
  std::array<Vec3, 3> normal;  ///< unit normals of the pieces there
};

/// Sine of the angle below which two pieces count as tangent to each other (2°): no crease is seen there, and none can
/// be placed exactly.
constexpr double kTangentSine = 0.035;

/// Determinant of three unit normals from which they span space: no corner is placed where they span less.
constexpr double kFlatCorner = 0.02;

/// Newton's method on all pieces of each at once, with steps of least length, so that the point found is about the one
/// nearest to `start`. Not found: where the pieces are tangent (kTangentSine; three: their normals span less than
/// kFlatCorner), where it would be out of reach, and where the field itself does not vanish.
void find_meetings(const PiecewiseField& field, std::span<Meeting> all);

}  // namespace sansmesh::inline v1
