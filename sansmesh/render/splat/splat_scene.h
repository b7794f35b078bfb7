// Particles of a surface as splats that blend (METHODS §5.2): no mesh is drawn.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/render/scene/picture_scene.h"
#include "sansmesh/render/scene/ray_scene.h"
#include "sansmesh/render_options.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Discs around particles, in coordinates of the picture. Arrays are as long as `centers`; `vectors` and `colors` may
/// be empty.
struct Splats {
  std::vector<Vec3f> centers, normals, vectors;
  std::vector<Vec3f> colors;          ///< linear light
  std::vector<float> spacings;        ///< distance h to neighbours; discs have a radius of 3/4 h
  std::vector<std::int32_t> fronts;   ///< particles of neighbouring moments have neighbouring numbers
  std::vector<std::int32_t> reaches;  ///< so many fronts on, the discs of one sheet may still overlap; >= 1
};

/// Splats at the vertices of a mesh, which is asked for nothing but who is near whom, in coordinates of the frame:
/// normals from the weighted covariance of the neighbours, h from the farthest of them. `vectors`: of each vertex or
/// none. Vertices without triangles and such as are not finite are left out.
Splats splats_at_vertices(const TriangleMesh& mesh, std::span<const Vec3f> vectors,
                          std::span<const std::int32_t> fronts, const RenderOptions& options,
                          const PictureFrame& frame);

/// Where several discs are hit one behind the other, position, normal, vector and colour are their means, weighted by
/// exp(−r²/h² − s²/(γ² h²)), r from the centre, s behind the first hit across its disc: of those that lie no deeper
/// than 2 γ h and whose fronts are neighbours of the first's. So a sheet that comes back to where it was at another
/// time is cut through crisply.
class SplatScene final : public PictureScene {
 public:
  /// `opacity` as of meshes (Subject).
  SplatScene(Splats splats, float opacity);
  void closest(const EyeRays& rays, std::span<std::optional<SurfacePoint>> points) const override;
  void layers(const EyeRays& rays, std::vector<std::size_t>& first, std::vector<SurfacePoint>& points) const override;
  void blocked(std::span<const ShadowRay> rays, std::span<std::uint8_t> answers) const override;

 private:
  SurfacePoint blend(const Vec3f& eye, const Vec3f& direction, std::span<const RayCrossing> hits) const;
  float steepness(std::uint32_t splat, const Vec3f& direction) const;
  float depth(std::uint32_t splat, const Vec3f& direction) const;
  void take_first(const Vec3f& direction, std::vector<RayCrossing>& hits, std::vector<RayCrossing>& sheet) const;

  Splats splats_;
  float opacity_;
  RayScene rays_;
};

}  // namespace sansmesh::inline v1
