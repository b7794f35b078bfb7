#include "sansmesh/triangle_mesh.h"

#include <utility>

namespace sansmesh::inline v1 {

TriangleMesh to_mesh(PointSet points) {
  TriangleMesh mesh;
  mesh.origin = points.origin;
  mesh.reference = std::move(points.reference);
  mesh.vertices = std::move(points.positions);
  mesh.triangles = std::move(points.triangles);
  mesh.normals = std::move(points.normals);
  mesh.colors = std::move(points.colors);
  mesh.attributes = std::move(points.attributes);
  mesh.triangle_attributes = std::move(points.triangle_attributes);
  return mesh;
}

}  // namespace sansmesh::inline v1
