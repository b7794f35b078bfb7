// Cuts along planes: half-planes that end at an edge, and polygons.
#pragma once

#include <memory>
#include <vector>

#include "sansmesh/deform/cuts/occluder.h"

namespace sansmesh::inline v1 {

/// A part of a plane. All queries have a closed form:
///
/// - The shortest detour bends once, on the border: unfolded about an edge of the border it is straight, in space ‖h −
///   b‖ + ‖b − x‖ with the best b on that edge; the best edge counts. Its excess over ‖h − x‖ grows with the square of
///   the angle by which x is in the shadow, so that it is differentiable there.
/// - The depth of a gap is the smaller of s(x) s(u) / (|s(x)| + |s(u)|), negated, with s the signed distance from the
///   plane and u the source of x, and the distance inside the border at which the segment from x to u crosses the
///   plane. For x and u on one side of it the crossing of the segment from x to the mirror image of u is used, so that
///   both terms are continuous.
///
/// Points in the plane itself count as on the side of the normal.
class PlanarOccluder final : public Occluder {
 public:
  struct Point {
    double a = 0, b = 0;
  };
  /// An edge of the border: from `begin` over `length` along a unit direction, with the occluder on its left; or a
  /// whole line.
  struct Edge {
    Point begin, along;
    double length = 0;  ///< infinite: a line, in both directions
  };

  void detours(const Vec3& handle, std::span<const Vec3> x, std::span<Detour> found) const override;
  void gaps(std::span<const Vec3> x, std::span<const Vec3> sources, std::span<const std::array<Vec3, 3>> jacobians,
            std::span<Gap> found) const override;
  void crossings(const Vec3& a, const Vec3& b, std::vector<double>& found) const override;
  void border_points(const Vec3& a, const Vec3& b, const Vec3& c, std::vector<Vec3>& found) const override;

  const Vec3& normal() const { return normal_; }
  /// Distance from the plane, positive on the side of the normal.
  double height(const Vec3& x) const { return dot(x - origin_, normal_); }
  /// Coordinates in the plane, in which (a, b, normal) is right-handed.
  Point in_plane(const Vec3& x) const { return {dot(x - origin_, a_), dot(x - origin_, b_)}; }
  Vec3 in_space(const Point& p) const { return origin_ + a_ * p.a + b_ * p.b; }
  /// Distance of a point of the plane from the border, positive inside. Its gradient is stored in *inwards unless that
  /// is null.
  double depth(const Point& p, Point* inwards) const;
  /// Closed borders: outer ones run counter-clockwise, holes clockwise; or a single line.
  const std::vector<std::vector<Edge>>& borders() const { return borders_; }

 private:
  friend std::shared_ptr<const PlanarOccluder> half_plane(const Vec3&, const Vec3&, const Vec3&);
  friend std::shared_ptr<const PlanarOccluder> polygon_occluder(const std::vector<std::vector<Vec3>>&);
  PlanarOccluder() = default;
  bool covers(const Point& p) const;

  Vec3 origin_, normal_, a_, b_;
  std::vector<std::vector<Edge>> borders_;
};

/// The half of the plane through `edge_point` with this normal that extends in the direction `into` from its edge, a
/// line through `edge_point` perpendicular to `into`. The component of `into` along the normal is ignored. Throws
/// ArgumentError if a direction is zero or not finite, or `into` is parallel to the normal.
std::shared_ptr<const PlanarOccluder> half_plane(const Vec3& edge_point, const Vec3& normal, const Vec3& into);

/// A polygon, convex or not: the first loop is its outline, others are holes, in any orientation; the normal is that of
/// the outline (right-hand rule). Throws ArgumentError if a loop has fewer than three distinct corners, corners are off
/// the plane by more than a millionth of the size, the outline has no area, edges cross each other, or a hole touches
/// another loop, is inside another hole or is not inside the outline.
std::shared_ptr<const PlanarOccluder> polygon_occluder(const std::vector<std::vector<Vec3>>& loops);

}  // namespace sansmesh::inline v1
