// Solids and functions with known measures.
#pragma once

#include <cmath>

#include "sansmesh/triangle_mesh.h"
#include "support/formula_field.h"
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
class SphereField : public FormulaField {
 public:
  explicit SphereField(double radius, const Vec3& center = {})
      : FormulaField(
            [=](const Vec3& x, Vec3& gradient) {
              gradient = normalized(x - center);
              return norm(x - center) - radius;
            },
            Box3{center - Vec3{1, 1, 1} * (radius + 0.3), center + Vec3{1, 1, 1} * (radius + 0.3)}) {}
};

/// Torus around z; its values are the distance times a factor that varies in space.
class TorusField : public FormulaField {
 public:
  TorusField()
      : FormulaField(
            [](const Vec3& x, Vec3& gradient) {
              const double d = distance_to_ring(x, gradient) - 0.35, stretch = 1 + 0.3 * x.x;
              gradient = gradient * stretch + Vec3{0.3 * d, 0, 0};
              return stretch * d;
            },
            Box3{{-1.6, -1.6, -0.6}, {1.6, 1.6, 0.6}}) {}
};

}  // namespace sansmesh::test
