// Solids and functions with known measures.
#pragma once

#include <cmath>

#include "sansmesh/scalar_field.h"
#include "sansmesh/triangle_mesh.h"
#include "support/mesh_shapes.h"

namespace sansmesh::test {

/// A box with 12 triangles, facing outward.
inline TriangleMesh box_mesh(const Vec3f& low, const Vec3f& high) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

inline TriangleMesh scaled(TriangleMesh mesh, float factor) {
  for (Vec3f& v : mesh.vertices) v *= factor;
  return mesh;
}

inline TriangleMesh turned_inside_out(TriangleMesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

/// Signed distance to a sphere.
class SphereField : public ScalarField {
 public:
  explicit SphereField(double radius, const Vec3& center = {}, double margin = 0.3)
      : radius_(radius), center_(center), margin_(margin) {}
  Box3 bounds() const override {
    const Vec3 half = Vec3{1, 1, 1} * (radius_ + margin_);
    return {center_ - half, center_ + half};
  }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      values[i] = norm(x[i] - center_) - radius_;
      if (!gradients.empty()) gradients[i] = normalized(x[i] - center_);
    }
  }

 private:
  double radius_;
  Vec3 center_;
  double margin_;
};

/// Torus around z; its values are the distance times a factor that varies in space.
class TorusField : public ScalarField {
 public:
  Box3 bounds() const override { return {{-1.6, -1.6, -0.6}, {1.6, 1.6, 0.6}}; }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vec3& p = x[i];
      const double r = std::hypot(p.x, p.y), d = std::hypot(r - 1, p.z), stretch = 1 + 0.3 * p.x;
      values[i] = stretch * (d - 0.35);
      if (gradients.empty()) continue;
      const Vec3 slope{(r - 1) / d * p.x / r, (r - 1) / d * p.y / r, p.z / d};
      gradients[i] = slope * stretch + Vec3{0.3 * (d - 0.35), 0, 0};
    }
  }
};

}  // namespace sansmesh::test
