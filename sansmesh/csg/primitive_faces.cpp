#include "sansmesh/csg/primitive_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "sansmesh/core/index_in.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kLeastSides = 12;
/// Mean distance of a polygon from the circle of equal area, over the height of the arcs above its chords: 4 / 9√3.
constexpr double kMeanOfChord = 0.2566;
/// Mean distance of ball_faces with n edges from the ball, times n² over the radius.
constexpr double kMeanOfBall = 0.1209;

/// Radius of the corners of a polygon over that of the circle of equal area.
double polygon_radius(std::size_t n) {
  const double angle = 2 * std::numbers::pi / static_cast<double>(n);
  return std::sqrt(angle / std::sin(angle));
}

/// cos and sin of i / n of a turn: exact at quarters, and symmetric.
std::array<double, 2> on_circle(std::size_t i, std::size_t n) {
  const std::size_t quarter = n / 4, turns = i / quarter, rest = i % quarter;
  const auto angle = [&](std::size_t k) {
    return 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
  };
  const bool near = 2 * rest <= quarter;
  const double a = angle(near ? rest : quarter - rest);
  double c = std::cos(a), s = std::sin(a);
  if (!near) std::swap(c, s);
  for (std::size_t t = 0; t < turns % 4; ++t) c = std::exchange(s, c), c = -c;
  return {c, s};
}

/// Two unit vectors that form a right-handed frame with the unit vector; along the axes if it is.
std::array<Vec3, 2> frame_around(const Vec3& axis) {
  std::size_t k = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if (std::abs(axis[i]) < std::abs(axis[k])) k = i;
  // Next to an axis, the following ones.
  for (std::size_t i = 0; i < 3; ++i)
    if (std::abs(axis[i]) > 0.9) k = (i + 1) % 3;
  Vec3 e;
  e[k] = 1;
  const Vec3 y = normalized(cross(axis, e));
  return {cross(y, axis), y};
}

void add_quad(SolidFaces& f, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  f.triangles.push_back({a, b, c});
  f.triangles.push_back({a, c, d});
}

/// Polygon of consecutive vertices, as strips across it.
void add_polygon(SolidFaces& f, std::uint32_t first, std::uint32_t n, bool reversed) {
  std::uint32_t low = 0, high = n - 1;
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (reversed) std::swap(b, c);
    f.triangles.push_back({first + a, first + b, first + c});
  };
  while (high - low > 1) {
    add(low, low + 1, high);
    ++low;
    if (high - low > 1) add(low, high - 1, high), --high;
  }
}

std::uint32_t add_circle(SolidFaces& f, const Vec3& center, const std::array<Vec3, 2>& frame, double radius,
                         std::size_t n) {
  const auto first = static_cast<std::uint32_t>(f.vertices.size());
  if (radius == 0) {
    f.vertices.push_back(center);
    return first;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const auto [c, s] = on_circle(i, n);
    f.vertices.push_back(center + frame[0] * (radius * c) + frame[1] * (radius * s));
  }
  return first;
}

/// Faces between two circles of n vertices, or a circle and a tip.
void add_band(SolidFaces& f, std::uint32_t lower, std::uint32_t upper, std::uint32_t n, bool low_tip, bool high_tip) {
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    if (low_tip) {
      f.triangles.push_back({lower, upper + j, upper + i});
    } else if (high_tip) {
      f.triangles.push_back({lower + i, lower + j, upper});
    } else {
      add_quad(f, lower + i, lower + j, upper + j, upper + i);
    }
  }
}

}  // namespace

std::size_t sides_of_circle(double radius, double error) {
  const double height = std::min(1.0, error / (kMeanOfChord * radius));
  const std::size_t n =
      index_in<std::size_t>(std::ceil(std::numbers::pi / std::acos(1 - height)), kLeastSides, kMostSides);
  return (n + 3) / 4 * 4;
}

std::size_t edges_of_quarter(double radius, double error) {
  return index_in<std::size_t>(std::ceil(std::sqrt(kMeanOfBall * radius / error)), kLeastSides / 3, kMostSides);
}

SolidFaces ball_faces(const Vec3& center, double radius, std::size_t edges) {
  const auto n = static_cast<std::uint32_t>(edges);
  SolidFaces f;
  // Latitude k from the north pole has 4 k vertices, down to the equator and back.
  std::vector<std::uint32_t> first(2 * n + 2, 0);
  const auto count = [&](std::uint32_t k) { return k <= n ? 4 * k : 4 * (2 * n - k); };
  for (std::uint32_t k = 0; k <= 2 * n; ++k) {
    first[k] = static_cast<std::uint32_t>(f.vertices.size());
    const std::uint32_t m = std::max(count(k), 1u), steps = k <= n ? k : 2 * n - k;
    for (std::uint32_t i = 0; i < m; ++i) {
      const std::uint32_t turn = steps > 0 ? i / steps : 0, along = steps > 0 ? i % steps : 0;
      // Barycentric coordinates on an octant, as sines of angles: nearly equal triangles.
      const auto sine = [&](std::uint32_t j) { return on_circle(j, 4 * std::size_t{n})[1]; };
      const Vec3 p = normalized(Vec3{sine(steps - along), sine(along), sine(n - steps)});
      const double z = k <= n ? p.z : -p.z;
      const std::array<Vec3, 4> turned{Vec3{p.x, p.y, z}, Vec3{-p.y, p.x, z}, Vec3{-p.x, -p.y, z}, Vec3{p.y, -p.x, z}};
      f.vertices.push_back(turned[turn]);
    }
  }
  for (std::uint32_t k = 0; k < 2 * n; ++k) {
    const bool north = k < n;
    // From the ring with fewer vertices to the one with more.
    const std::uint32_t small = north ? k : k + 1, large = north ? k + 1 : k;
    const std::uint32_t few = count(small), many = count(large), steps = few / 4;
    const auto at_small = [&](std::uint32_t i) { return first[small] + (few == 0 ? 0 : i % few); };
    const auto at_large = [&](std::uint32_t i) { return first[large] + i % many; };
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      if (!north) std::swap(b, c);
      f.triangles.push_back({a, b, c});
    };
    for (std::uint32_t turn = 0; turn < 4; ++turn)
      for (std::uint32_t i = 0; i <= steps; ++i) {
        const std::uint32_t s = turn * steps + i, l = turn * (steps + 1) + i;
        add(at_small(s), at_large(l), at_large(l + 1));
        if (i < steps) add(at_small(s), at_large(l + 1), at_small(s + 1));
      }
  }
  double volume = 0;
  for (const auto& [a, b, c] : f.triangles) volume += dot(f.vertices[a], cross(f.vertices[b], f.vertices[c])) / 6;
  const double grown = radius * std::cbrt(4 * std::numbers::pi / 3 / volume);
  for (Vec3& v : f.vertices) v = center + v * grown;
  return f;
}

SolidFaces box_faces(const Vec3& lower, const Vec3& upper) {
  SolidFaces f;
  for (std::uint32_t c = 0; c < 8; ++c)
    f.vertices.push_back(
        {(c & 1) != 0 ? upper.x : lower.x, (c & 2) != 0 ? upper.y : lower.y, (c & 4) != 0 ? upper.z : lower.z});
  for (const auto& [a, b, c, d] :
       {std::array<std::uint32_t, 4>{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}})
    add_quad(f, a, b, c, d);
  return f;
}

SolidFaces frustum_faces(const Vec3& center, const Vec3& axis, double bottom, double top, double half_height,
                         std::size_t sides) {
  SolidFaces f;
  const std::array<Vec3, 2> frame = frame_around(axis);
  const auto n = static_cast<std::uint32_t>(sides);
  const double grown = polygon_radius(sides);
  const std::uint32_t low = add_circle(f, center - axis * half_height, frame, bottom * grown, sides);
  const std::uint32_t high = add_circle(f, center + axis * half_height, frame, top * grown, sides);
  add_band(f, low, high, n, bottom == 0, top == 0);
  if (bottom > 0) add_polygon(f, low, n, true);
  if (top > 0) add_polygon(f, high, n, false);
  return f;
}

SolidFaces ring_faces(const Vec3& center, const Vec3& axis, double ring, double tube, std::size_t sides_of_ring,
                      std::size_t sides_of_tube) {
  SolidFaces f;
  const std::array<Vec3, 2> frame = frame_around(axis);
  const double grown = tube * polygon_radius(sides_of_tube);
  const auto m = static_cast<std::uint32_t>(sides_of_ring), n = static_cast<std::uint32_t>(sides_of_tube);
  for (std::uint32_t i = 0; i < m; ++i) {
    const auto [c, s] = on_circle(i, m);
    const Vec3 outward = (frame[0] * c + frame[1] * s) * polygon_radius(m);
    for (std::uint32_t j = 0; j < n; ++j) {
      const auto [u, v] = on_circle(j, n);
      f.vertices.push_back(center + outward * (ring + grown * u) + axis * (grown * v));
    }
  }
  for (std::uint32_t i = 0; i < m; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t k = (i + 1) % m, l = (j + 1) % n;
      add_quad(f, i * n + j, k * n + j, k * n + l, i * n + l);
    }
  return f;
}

SolidFaces rod_faces(const Vec3& from, const Vec3& to, double given_radius, std::size_t sides) {
  SolidFaces f;
  const double radius = given_radius * polygon_radius(sides);
  const Vec3 axis = normalized(to - from);
  const std::array<Vec3, 2> frame = frame_around(axis);
  const auto n = static_cast<std::uint32_t>(sides);
  const std::size_t quarter = sides / 4;
  std::uint32_t last = add_circle(f, from - axis * radius, frame, 0, sides);
  const auto add_ring = [&](const Vec3& center, std::size_t latitude) {
    const auto [c, s] = on_circle(latitude, sides);
    return add_circle(f, center + axis * (radius * s), frame, radius * c, sides);
  };
  for (std::size_t k = 1; k <= 2 * quarter; ++k) {  // latitudes −quarter + k; the equator twice
    const std::size_t up = k <= quarter ? quarter - k : k - quarter - 1;
    const std::uint32_t next = k <= quarter ? add_circle(f, from - axis * (radius * on_circle(up, sides)[1]), frame,
                                                         radius * on_circle(up, sides)[0], sides)
                                            : add_ring(to, up);
    add_band(f, last, next, n, k == 1, false);
    last = next;
  }
  add_band(f, last, add_circle(f, to + axis * radius, frame, 0, sides), n, false, true);
  return f;
}

SolidFaces half_space_faces(const Vec3& normal, double offset, const Vec3& center, double radius) {
  const double height = offset - dot(normal, center);  // height of the plane above the centre
  if (height <= -radius) return {};
  const std::array<Vec3, 2> frame = frame_around(normal);
  SolidFaces f;
  for (const double z : {-2 * radius, height})
    for (const auto& [x, y] : {std::array<double, 2>{-1, -1}, {1, -1}, {-1, 1}, {1, 1}}) {
      Vec3 p = center + frame[0] * (2 * radius * x) + frame[1] * (2 * radius * y) + normal * z;
      for (std::size_t k = 0; k < 3 && z == height; ++k)  // exact on planes across an axis
        if (std::abs(normal[k]) == 1) p[k] = normal[k] * offset;
      f.vertices.push_back(p);
    }
  const std::vector<Triangle> triangles = box_faces({}, {1, 1, 1}).triangles;
  f.triangles = triangles;
  return f;
}

}  // namespace sansmesh::inline v1
