// Blended splats of surface particles (tejada2008, 5.3), without a mesh.
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
  std::vector<Vec3f> colors;         ///< linear light
  std::vector<float> spacings;       ///< distance h to neighbours; discs have a radius of 3/4 h
  std::vector<std::int32_t> fronts;  ///< neighbouring numbers are neighbours in time
  std::vector<std::int32_t>
      reaches;  ///< number of following fronts whose discs may overlap this one on the same sheet; >= 1
};

/// Splats at the vertices of a mesh, in coordinates of the frame. The mesh only provides neighbourhoods: normals from
/// the weighted covariance of the neighbours, h from the farthest of them. `vectors`: one per vertex, or none. Vertices
/// that are not finite or have no triangles are left out.
Splats splats_at_vertices(const TriangleMesh& mesh, std::span<const Vec3f> vectors,
                          std::span<const std::int32_t> fronts, const RenderOptions& options,
                          const PictureFrame& frame);

/// Where a ray hits several discs, position, normal, vector and colour are their means, weighted by exp(−r²/h² − s²/(γ²
/// h²)), with r the distance from the centre and s the distance behind the first hit, perpendicular to its disc. Only
/// discs no deeper than 2 γ h count whose fronts are neighbours of the first's. So a sheet that returns to the same
/// position at another time is separated crisply.
class SplatScene final : public PictureScene {
 public:
  /// `opacity` as in Subject.
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
