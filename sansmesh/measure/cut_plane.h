// Planes that cut: where they lie, and coordinates within them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// The points x with ⟨normal, x⟩ = offset, and a frame (u, v, normal), right-handed and orthonormal. The coordinates of
/// x within the plane are (⟨u, x⟩, ⟨v, x⟩): for z = c these are x and y, for x = c y and z, for y = c z and x.
struct CutPlane {
  Vec3 normal{0, 0, 1};
  double offset = 0;
  Vec3 u{1, 0, 0}, v{0, 1, 0};

  double height(const Vec3& x) const { return dot(normal, x) - offset; }
  Vec3 at(double a, double b) const { return u * a + v * b + normal * offset; }
};

/// ⟨normal, x⟩ = offset for a normal of any length (both are divided by it). Throws ArgumentError unless all is finite
/// and the normal has a direction.
CutPlane cut_plane(const Vec3& normal, double offset);

/// x, y or z (axis 0, 1 or 2) = value.
CutPlane axis_plane(int axis, double value);

/// `count` planes across an axis at start, start + step, … Throws ArgumentError if count < 1 or > 100000, the step is
/// not finite, or 0 for several planes.
std::vector<CutPlane> plane_series(int axis, double start, double step, int count);

/// `count` planes across an axis that cut the box into count + 1 slices of equal thickness.
std::vector<CutPlane> spread_planes(const Box3& box, int axis, int count);

/// Three planes, x, y and z = c, through the middle of the box.
std::vector<CutPlane> middle_planes(const Box3& box);

/// "z=0.5", or "nx,ny,nz,d" for ⟨n, x⟩ = d. Throws ArgumentError that quotes the text.
CutPlane parse_plane(const std::string& text);

/// As options of schemas (sansmesh/option.h): as parse_plane reads it, to the last digit.
std::string text_of_option(const CutPlane& plane);
inline void option_of_text(std::string_view text, CutPlane& plane) { plane = parse_plane(std::string(text)); }

/// "z = 0.5", or "0.6 x + 0.8 y = 1".
std::string equation(const CutPlane& plane);

}  // namespace sansmesh::inline v1
