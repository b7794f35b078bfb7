// Analytic volumes and their boundaries.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/volume_field.h"

namespace sansmesh::test {

/// A formula with its gradient, inside of `in` (the whole box by default).
class FormulaVolume : public VolumeField {
 public:
  std::function<double(const Vec3&)> value;
  std::function<Vec3(const Vec3&)> gradient;
  std::function<bool(const Vec3&)> in;
  Box3 box{{0, 0, 0}, {1, 1, 1}};
  double step = 1.0 / 32;

  Box3 bounds() const override { return box; }
  std::size_t components() const override { return 1; }
  void evaluate(std::span<const Vec3> x, const VolumeFieldValues& wanted) const override {
    parallel_for(0, x.size(), 512, [&](std::size_t i) {
      if (!wanted.values.empty()) wanted.values[i] = value(x[i]);
      if (!wanted.gradients.empty()) wanted.gradients[i] = gradient(x[i]);
      if (!wanted.inside.empty()) wanted.inside[i] = in ? in(x[i]) : box.contains(x[i]);
    });
  }
  void spacing(std::span<const Vec3> x, std::span<double> found) const override {
    std::fill_n(found.begin(), x.size(), step);
  }
};

inline FormulaVolume constant_volume(double value) {
  FormulaVolume v;
  v.value = [value](const Vec3&) { return value; };
  v.gradient = [](const Vec3&) { return Vec3{}; };
  return v;
}

/// ⟨g, x⟩ + c.
inline FormulaVolume linear_volume(const Vec3& g, double c = 0) {
  FormulaVolume v;
  v.value = [g, c](const Vec3& x) { return dot(g, x) + c; };
  v.gradient = [g](const Vec3&) { return g; };
  return v;
}

/// Distance from a point.
inline FormulaVolume ball_volume(const Vec3& center) {
  FormulaVolume v;
  v.value = [center](const Vec3& x) { return norm(x - center); };
  v.gradient = [center](const Vec3& x) { return normalized(x - center); };
  return v;
}

/// ⟨g, x⟩ in two small balls far apart, which fill a part in 10⁷ of their box: only very fine lattices have a point in
/// them.
struct TwoSpecks {
  FormulaVolume field;
  std::array<Vec3, 2> centers{Vec3{0.1031, 0.1147, 0.1273}, Vec3{0.9117, 0.8853, 0.8719}};
  double radius = 0.0023;

  explicit TwoSpecks(const Vec3& g) : field(linear_volume(g)) {
    field.in = [this](const Vec3& x) { return std::min(norm(x - centers[0]), norm(x - centers[1])) < radius; };
    field.step = 0.2 * radius;
  }
  TwoSpecks(const TwoSpecks&) = delete;
  TwoSpecks& operator=(const TwoSpecks&) = delete;

  /// Spread over the insides of both.
  std::vector<Vec3> points() const {
    std::vector<Vec3> x;
    for (const Vec3& c : centers)
      for (int k = -1; k <= 1; ++k)
        for (int j = -1; j <= 1; ++j)
          for (int i = -1; i <= 1; ++i) x.push_back(c + Vec3{1. * i, 1. * j, 1. * k} * (0.5 * radius));
    return x;
  }
};

/// The surface of a box, oriented outwards.
inline TriangleMesh box_surface(const Vec3& lower, const Vec3& upper) {
  TriangleMesh mesh;
  for (int c = 0; c < 8; ++c)
    mesh.vertices.push_back(
        Vec3f(Vec3{c & 1 ? upper.x : lower.x, c & 2 ? upper.y : lower.y, c & 4 ? upper.z : lower.z}));
  for (const std::array<std::uint32_t, 4>& q : {std::array<std::uint32_t, 4>{0, 2, 3, 1},
                                                {4, 5, 7, 6},
                                                {0, 1, 5, 4},
                                                {2, 6, 7, 3},
                                                {0, 4, 6, 2},
                                                {1, 3, 7, 5}}) {
    mesh.triangles.push_back({q[0], q[1], q[2]});
    mesh.triangles.push_back({q[0], q[2], q[3]});
  }
  return mesh;
}

/// The surface of a square ring about the middle of [0, 1]³ along z, with a hole of [0.3, 0.7]²; it has the same frame
/// as the box.
inline TriangleMesh ring_surface() {
  TriangleMesh mesh;
  const double out[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}},
               in[4][2] = {{0.3, 0.3}, {0.7, 0.3}, {0.7, 0.7}, {0.3, 0.7}};
  for (const double z : {0.0, 1.0})
    for (const auto& corners : {out, in})
      for (int k = 0; k < 4; ++k) mesh.vertices.push_back(Vec3f(Vec3{corners[k][0], corners[k][1], z}));
  const auto quad = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  };
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::uint32_t n = (k + 1) % 4;
    quad(k, n, 8 + n, 8 + k);            // outer walls
    quad(4 + n, 4 + k, 12 + k, 12 + n);  // walls of the hole
    quad(8 + k, 8 + n, 12 + n, 12 + k);  // top
    quad(n, k, 4 + k, 4 + n);            // bottom
  }
  return mesh;
}

}  // namespace sansmesh::test
