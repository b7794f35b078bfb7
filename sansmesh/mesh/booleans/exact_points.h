// Points where edges and planes of triangles meet, and exact predicates on them.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "sansmesh/core/bounded.h"
#include "sansmesh/core/dyadic.h"
#include "sansmesh/core/residue.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// The plane through three corners; with an axis, the plane through the first two that contains this direction.
struct FacePlane {
  std::array<std::uint32_t, 3> corner{};
  int axis = -1;
};

/// A point given by its construction from corners (attene2020): a corner, the crossing of an edge and a plane, or the
/// point of three planes. Its coordinates are known with error bounds, and exactly modulo a prime: equal points have
/// equal residues, also if they are constructed differently.
struct ExactPoint {
  enum class Kind : std::uint8_t { corner, crossing, meeting };
  Kind kind = Kind::corner;
  std::array<std::uint32_t, 2> edge{};  ///< edge of a crossing; a corner is the first
  std::array<FacePlane, 3> planes{};    ///< a crossing uses the first
  std::array<Bounded, 3> at;
  std::array<Residue, 3> residue;

  bool same_position(const ExactPoint& o) const { return residue == o.residue; }
  Vec3 approximate() const { return {at[0].value, at[1].value, at[2].value}; }
};

/// The mean of three points.
struct ExactMean {
  std::array<const ExactPoint*, 3> of{};
  std::array<Bounded, 3> at;
  std::array<Residue, 3> residue;

  Vec3 approximate() const { return {at[0].value, at[1].value, at[2].value}; }
};

/// Constructions and predicates over an array of corners. A predicate evaluates its formula with error bounds, then
/// modulo a prime, which recognises zero, and last with exact numbers.
class ExactSpace {
 public:
  /// The array must outlive this.
  explicit ExactSpace(std::span<const Vec3> corners) : corners_(corners) {}

  const Vec3& position(std::uint32_t corner) const { return corners_[corner]; }

  ExactPoint corner(std::uint32_t v) const;
  /// The edge has ends on both sides of the plane.
  ExactPoint crossing(std::uint32_t a, std::uint32_t b, const FacePlane& plane) const;
  /// The planes have exactly one common point.
  ExactPoint meeting(const FacePlane& p, const FacePlane& q, const FacePlane& r) const;
  /// The points must outlive the mean.
  ExactMean mean(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c) const;
  /// Coordinates to nearly full double precision.
  Vec3 rounded(const ExactPoint& point) const;

  /// Sign of det(b − a, c − a, d − a): positive if d is on the side of the normal of (a, b, c).
  int side(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const;
  int side(std::uint32_t a, std::uint32_t b, std::uint32_t c, const ExactMean& p) const;
  /// Sign of component `axis` of (b − a) × (c − a).
  int turn(std::uint32_t a, std::uint32_t b, std::uint32_t c, int axis) const;
  int turn(std::uint32_t a, std::uint32_t b, const ExactMean& p, int axis) const;
  int turn(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, int axis) const;
  /// The axis along which the normal of a triangle is longest, nearly; −1 if the corners are collinear.
  int main_axis(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;

 private:
  struct Homogeneous {
    std::array<Dyadic, 3> x;
    Dyadic w;
  };
  Homogeneous homogeneous(std::uint32_t corner) const;
  Homogeneous homogeneous(const ExactPoint& point) const;
  Homogeneous homogeneous(const ExactMean& point) const;
  static int exact_turn(const Homogeneous& a, const Homogeneous& b, const Homogeneous& c, int axis);
  template <class N>
  std::array<N, 3> position(std::uint32_t v) const;
  template <class N>
  std::array<N, 3> normal(const FacePlane& plane) const;
  template <class N>
  struct Quotient;
  template <class N>
  Quotient<N> quotient(const ExactPoint& point) const;
  void complete(ExactPoint& point) const;

  std::span<const Vec3> corners_;
};

}  // namespace sansmesh::inline v1
