// The edges of triangles as lines of an even width in pixels.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sansmesh/render/scene/camera.h"
#include "sansmesh/render/scene/ray_scene.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// A line is drawn on the triangles on both sides of its edge, half as wide on each; where the other one is not seen or
/// there is none, all of it on this one. So what hides a triangle hides its lines.
class MeshWires {
 public:
  MeshWires() = default;
  /// The mesh in the picture's coordinates must outlive it. `height`: of the picture in pixels, each of which has
  /// samples × samples rays; `width` of lines in pixels.
  MeshWires(const TriangleMesh& mesh, const Camera& camera, int height, int samples, double width);

  bool empty() const { return others_.empty(); }
  /// How much of what a ray of the camera from `origin` stands for is covered by lines, 0..1, where it hits the mesh.
  float cover(const RayHit& hit, const Vec3f& origin, const Vec3f& direction) const;

 private:
  Vec3f normal(std::uint32_t triangle) const;

  const TriangleMesh* mesh_ = nullptr;
  Camera camera_;
  float pixel_ = 0;                                   // its width at depth 1
  float half_ = 0;                                    // of the width, in pixels
  float sharpness_ = 1;                               // rays a pixel
  std::vector<std::array<std::uint32_t, 3>> others_;  // behind the edge opposite of each corner
};

}  // namespace sansmesh::inline v1
