// Scene of a mesh or cloud, cleaned and scaled.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/render/scene/mesh_wires.h"
#include "sansmesh/render/scene/picture_scene.h"
#include "sansmesh/render/scene/ray_scene.h"
#include "sansmesh/render_options.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// The drawable part of a mesh, moved and scaled to a box with centre 0 and diagonal 1.
struct Subject {
  TriangleMesh mesh;           ///< finite vertices, used by triangles if there are any; corners exist
  std::vector<Vec3f> vectors;  ///< flow at the vertices; may be empty
  float radius = 0;            ///< radius of points; 0 for triangles
  PictureFrame frame;          ///< position and size in world coordinates
  /// Opacity of a triangle that faces the viewer, 0..1; it increases at oblique angles.
  float opacity = 1;
};

/// Throws DataError if nothing is left.
Subject make_subject(const TriangleMesh& mesh, const RenderOptions& options);
/// The same in a given frame. `vectors` at the vertices of the mesh, or none.
Subject make_subject(const TriangleMesh& mesh, const RenderOptions& options, const PictureFrame& frame,
                     std::span<const Vec3f> vectors = {});

class MeshScene : public PictureScene {
 public:
  /// Discs without a normal face the camera.
  MeshScene(Subject subject, const RenderOptions& options, const Camera& camera);
  void closest(const EyeRays& rays, std::span<std::optional<SurfacePoint>> points) const override;
  void layers(const EyeRays& rays, std::vector<std::size_t>& first, std::vector<SurfacePoint>& points) const override;
  void blocked(std::span<const ShadowRay> rays, std::span<std::uint8_t> answers) const override;
  const std::vector<Vec3f>& points() const { return subject_.mesh.vertices; }

 private:
  SurfacePoint seen(const RayHit& hit, const Vec3f& eye, const Vec3f& direction) const;
  SurfacePoint on_triangle(const RayHit& hit, const Vec3f& at) const;
  Vec3f vertex_color(std::uint32_t vertex) const;
  bool clear(const RayHit& hit, const Vec3f& eye, const Vec3f& direction) const;

  Subject subject_;
  RayScene rays_;
  std::vector<Vec3f> corner_normals_;  // empty: flat shading
  std::vector<float> linear_;          // linear light for each byte value
  MeshWires wires_;
  bool only_wires_ = false;
  Vec3f color_, wire_color_;
};

}  // namespace sansmesh::inline v1
