// Thin shapes of high genus with known truth: difficult for blends of local functions, whose supports reach through
// thin walls. Deterministic.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/point_set.h"
#include "sansmesh/points/sampling/poisson_discs.h"
#include "sansmesh/scalar_field.h"

namespace sansmesh::test {

/// Solid: negative inside, approximately a distance near its surface.
struct ThinShape : ScalarField {
  std::function<double(const Vec3&)> value;
  Box3 box;

  Vec3 gradient(const Vec3& p) const {
    constexpr double h = 1e-5;
    return Vec3{value({p.x + h, p.y, p.z}) - value({p.x - h, p.y, p.z}),
                value({p.x, p.y + h, p.z}) - value({p.x, p.y - h, p.z}),
                value({p.x, p.y, p.z + h}) - value({p.x, p.y, p.z - h})} /
           (2 * h);
  }
  Box3 bounds() const override { return box; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      values[i] = value(x[i]);
      if (!gradients.empty()) gradients[i] = gradient(x[i]);
    }
  }
};

/// Intersection with edges rounded by the given radius.
inline double rounded_both(double a, double b, double radius) {
  if (radius <= 0) return std::max(a, b);
  const double p = a + radius, q = b + radius;
  return std::min(std::max(p, q), 0.0) + std::hypot(std::max(p, 0.0), std::max(q, 0.0)) - radius;
}

inline Box3 cube_of(double half) { return {{-half, -half, -half}, {half, half, half}}; }

/// Wall of the given thickness along a gyroid of period 1 (cubic cells of edge 1) within a ball, with a rounded rim.
inline ThinShape gyroid_shell(double thickness, double radius) {
  ThinShape shape;
  shape.box = cube_of(1.1 * radius);
  shape.value = [=](const Vec3& x) {
    const Vec3 p = x * (2 * std::numbers::pi);
    const double sx = std::sin(p.x), cx = std::cos(p.x), sy = std::sin(p.y), cy = std::cos(p.y), sz = std::sin(p.z),
                 cz = std::cos(p.z);
    const double g = sx * cy + sy * cz + sz * cx;
    const double slope = norm(Vec3{cx * cy - sz * sx, cy * cz - sx * sy, cz * cx - sy * sz});
    // Far from the wall the slope vanishes at some points; accuracy is not needed there.
    const double wall = std::abs(g) / (2 * std::numbers::pi * std::max(slope, 0.3)) - 0.5 * thickness;
    return rounded_both(wall, norm(x) - radius, 0.5 * thickness);
  };
  return shape;
}

/// Straight chain of `count` linked tori with radii 1 and `thin` (below 0.15), each rotated by a right angle against
/// the previous one, without contact.
inline ThinShape linked_tori(int count, double thin) {
  ThinShape shape;
  const double pitch = 1.15, half = 0.5 * pitch * (count - 1);
  shape.box = {{-half - 1.3 - thin, -1.3 - thin, -1.3 - thin}, {half + 1.3 + thin, 1.3 + thin, 1.3 + thin}};
  shape.value = [=](const Vec3& x) {
    double nearest = 1e30;
    for (int i = 0; i < count; ++i) {
      const Vec3 p{x.x - pitch * i + half, i % 2 ? x.z : x.y, i % 2 ? x.y : x.z};
      nearest = std::min(nearest, std::hypot(std::hypot(p.x, p.y) - 1, p.z) - thin);
    }
    return nearest;
  };
  return shape;
}

/// Square plate of edge 2 with holes × holes round holes, its edges rounded or (`sharp`) at right angles.
inline ThinShape perforated_plate(double thickness, int holes, bool sharp) {
  ThinShape shape;
  shape.box = {{-1.1, -1.1, -0.2}, {1.1, 1.1, 0.2}};
  shape.value = [=](const Vec3& x) {
    const double pitch = 1.8 / holes, radius = 0.3 * pitch;
    const auto off = [&](double v) {
      const double cell = std::clamp(std::floor((v + 0.9) / pitch), 0.0, holes - 1.0);
      return v + 0.9 - (cell + 0.5) * pitch;
    };
    const double outline = std::max(std::abs(x.x), std::abs(x.y)) - 1;
    const double corner = rounded_both(std::abs(x.x) - 1, std::abs(x.y) - 1, sharp ? 0 : 0.1);
    const double plane = std::max(sharp ? outline : corner, radius - std::hypot(off(x.x), off(x.y)));
    return rounded_both(plane, std::abs(x.z) - 0.5 * thickness, sharp ? 0 : 0.5 * thickness);
  };
  return shape;
}

/// Pipe of radius 0.5 and length 2 with the given wall thickness and rounded ends.
inline ThinShape thin_tube(double thickness) {
  ThinShape shape;
  shape.box = cube_of(1.1);
  shape.value = [=](const Vec3& x) {
    return rounded_both(std::abs(std::hypot(x.x, x.y) - 0.5) - 0.5 * thickness, std::abs(x.z) - 1, 0.5 * thickness);
  };
  return shape;
}

/// Evenly spaced samples of the shape's surface with exact normals; mean spacing `spacing` (√(area / count)).
inline PointSet even_samples(const ThinShape& shape, double spacing, unsigned seed = 1) {
  // Points uniform in a narrow band, projected onto the surface along its normals, are uniform in area; then thinned.
  // Skips cells far from the surface.
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const double radius = 0.83 * spacing, band = 0.25 * spacing, cell = 3 * spacing;
  const auto tries = static_cast<int>(8 * cell * cell * cell / (2 * band * spacing * spacing));
  std::vector<Vec3> found;
  for (double z = shape.box.lower.z; z < shape.box.upper.z; z += cell)
    for (double y = shape.box.lower.y; y < shape.box.upper.y; y += cell)
      for (double x = shape.box.lower.x; x < shape.box.upper.x; x += cell) {
        const Vec3 corner{x, y, z};
        if (std::abs(shape.value(corner + Vec3{1, 1, 1} * (0.5 * cell))) > 2 * cell) continue;
        for (int i = 0; i < tries; ++i) {
          Vec3 p = corner + Vec3{unit(random), unit(random), unit(random)} * cell;
          if (std::abs(shape.value(p)) > band) continue;
          for (int step = 0; step < 6; ++step) {
            const Vec3 g = shape.gradient(p);
            p -= g * (shape.value(p) / std::max(dot(g, g), 0.1));
          }
          if (std::abs(shape.value(p)) < 1e-6) found.push_back(p);
        }
      }
  PointSet cloud;
  for (const std::uint32_t i : poisson_discs(found, radius)) {
    cloud.positions.emplace_back(found[i]);
    cloud.normals.emplace_back(normalized(shape.gradient(found[i])));
  }
  return cloud;
}

}  // namespace sansmesh::test
