// What a picture shows: a mesh or cloud, cleaned, scaled to a handy size and ready for rays.
#pragma once

#include <optional>
#include <vector>

#include "sansmesh/data/triangle_mesh.h"
#include "sansmesh/render/mesh_preview.h"
#include "sansmesh/render/ray_scene.h"

namespace sansmesh {

/// The part of a mesh that can be drawn, moved and scaled so that its box is centred at 0 with a diagonal of 1.
struct Subject {
  TriangleMesh mesh;  ///< finite vertices, used by triangles if there are any; corners exist
  float radius = 0;   ///< of points; 0 for triangles
};

/// Throws DataError where nothing is left.
Subject make_subject(const TriangleMesh& mesh, const RenderOptions& options);

/// sRGB 0..1 → linear light.
Vec3f linear_color(const Vec3f& srgb);

/// Where a ray from the eye ends.
struct SurfacePoint {
  Vec3f position;  ///< just off the surface on the viewer's side: further rays start here
  Vec3f normal;    ///< for shading, unit, on the viewer's side
  Vec3f color;     ///< share of light reflected, linear
};

class PreviewScene {
 public:
  /// `toward_viewer`: normal of discs that have none.
  PreviewScene(Subject subject, const RenderOptions& options, const Vec3f& toward_viewer);
  std::optional<SurfacePoint> closest(const Vec3f& origin, const Vec3f& direction) const;
  bool blocked(const Vec3f& origin, const Vec3f& direction, float length) const {
    return rays_.blocked(origin, direction, length);
  }
  const std::vector<Vec3f>& points() const { return subject_.mesh.vertices; }

 private:
  SurfacePoint on_triangle(const RayHit& hit, const Vec3f& at) const;
  Vec3f vertex_color(std::uint32_t vertex) const;

  Subject subject_;
  RayScene rays_;
  std::vector<Vec3f> corner_normals_;  // empty: flat
  std::vector<float> linear_;          // linear light of a byte
  Vec3f color_;
};

}  // namespace sansmesh
