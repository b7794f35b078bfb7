// Pictures of surface points as blended splats, without a mesh or rays at the surface.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include "sansmesh/image.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/scene/picture_scene.h"
#include "sansmesh/render/scene/ray_scene.h"
#include "sansmesh/render/splat/splat_layers.h"
#include "sansmesh/render_options.h"

namespace sansmesh::inline v1 {

/// Elongation of a splat.
struct SplatStretch {
  Vec3f direction;  ///< any length; only its tangential part is used
  float ratio = 1;  ///< >= 1
};

/// One splat per point, in coordinates of the frame: as wide as the distance to its neighbours on the same sheet, and
/// elongated by `stretches` unless that is empty. Points that are not finite or have no normal are left out. Throws
/// DataError if none is left, ArgumentError unless there are as many stretches as points, or none.
EllipticSplats splats_at_points(const PointSet& points, std::span<const SplatStretch> stretches,
                                const RenderOptions& options, const PictureFrame& frame);

/// Scene of SplatLayers with common lighting: eye rays find the layers of their pixel, shadow rays meet discs.
class BlendedScene final : public PictureScene {
 public:
  /// All arguments must outlive the scene. The layers must be made with the same camera and options, clipped as in the
  /// options.
  BlendedScene(const SplatLayers& layers, const RayScene& discs, const Camera& camera, const RenderOptions& options);
  void closest(const EyeRays& rays, std::span<std::optional<SurfacePoint>> points) const override;
  void blocked(std::span<const ShadowRay> rays, std::span<std::uint8_t> answers) const override;

 private:
  const SplatLayers& layers_;
  const RayScene& discs_;
  const Camera& camera_;
  const RenderOptions& options_;
};

/// Points for one or more pictures.
class SplatPicture {
 public:
  /// Arguments as in splats_at_points(). `options`: those of the pictures; they give the colour of the splats.
  SplatPicture(const PointSet& points, std::span<const SplatStretch> stretches, const RenderOptions& options);
  ~SplatPicture();
  SplatPicture(const SplatPicture&) = delete;
  SplatPicture& operator=(const SplatPicture&) = delete;

  std::size_t size() const;
  /// Lit as in render_mesh(); does not depend on the number of threads. Throws ArgumentError for bad options.
  Image render(const RenderOptions& options, Progress& progress) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sansmesh::inline v1
