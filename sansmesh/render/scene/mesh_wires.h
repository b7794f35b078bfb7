// Edges of triangles as lines of constant width in pixels.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sansmesh/render/scene/camera.h"
#include "sansmesh/render/scene/ray_scene.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// A line is drawn on the triangles on both sides of its edge, half of its width on each; entirely on this one if the
/// other is missing or not visible. So lines are occluded together with their triangles.
class MeshWires {
 public:
  MeshWires() = default;
  /// The mesh, in picture coordinates, must outlive this. `height`: of the picture in pixels, each with samples ×
  /// samples rays; `width` of lines in pixels.
  MeshWires(const TriangleMesh& mesh, const Camera& camera, int height, int samples, double width);

  bool empty() const { return others_.empty(); }
  /// Share of a ray's footprint that lines cover, 0..1, for a ray of the camera from `origin` at its hit on the mesh.
  float cover(const RayHit& hit, const Vec3f& origin, const Vec3f& direction) const;

 private:
  Vec3f normal(std::uint32_t triangle) const;

  const TriangleMesh* mesh_ = nullptr;
  Camera camera_;
  float pixel_ = 0;                                   // its width at depth 1
  float half_ = 0;                                    // half the line width in pixels
  float sharpness_ = 1;                               // rays per pixel
  std::vector<std::array<std::uint32_t, 3>> others_;  // triangle across the edge opposite of each corner
};

}  // namespace sansmesh::inline v1
