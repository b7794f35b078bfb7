// What a picture shows: a mesh or cloud, cleaned, scaled to a handy size and ready for rays.
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

/// The part of a mesh that can be drawn, moved and scaled so that its box is centred at 0 with a diagonal of 1.
struct Subject {
  TriangleMesh mesh;           ///< finite vertices, used by triangles if there are any; corners exist
  std::vector<Vec3f> vectors;  ///< of a flow at its vertices; may be empty
  float radius = 0;            ///< of points; 0 for triangles
  PictureFrame frame;          ///< where all that lies in the world
  /// Of a sheet of triangles seen at right angles, 0..1; seen at others it is thicker.
  float opacity = 1;
};

/// Throws DataError where nothing is left.
Subject make_subject(const TriangleMesh& mesh, const RenderOptions& options);
/// The same in coordinates of the caller's choice, given for positions in the world. `vectors` at the vertices of the
/// mesh, or none.
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
  std::vector<Vec3f> corner_normals_;  // empty: flat
  std::vector<float> linear_;          // linear light of a byte
  MeshWires wires_;
  bool only_wires_ = false;
  Vec3f color_, wire_color_;
};

}  // namespace sansmesh::inline v1
