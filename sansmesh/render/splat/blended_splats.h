// Pictures of points of a surface as splats that blend: no mesh, and no rays at the surface.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/image.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/scene/picture_scene.h"
#include "sansmesh/render/scene/ray_scene.h"
#include "sansmesh/render/splat/splat_layers.h"
#include "sansmesh/render_options.h"

namespace sansmesh::inline v1 {

/// How much longer than wide a splat is, and along what.
struct SplatStretch {
  Vec3f direction;  ///< of any length; its part in the tangent plane counts
  float ratio = 1;  ///< >= 1
};

/// A splat at each point, in coordinates of the frame: as wide as its neighbours on the same sheet are far, and, unless
/// `stretches` is empty, longer by those. Points that are not finite or have no normal are left out. Throws DataError
/// where none is left, ArgumentError unless there are as many stretches as points, or none.
EllipticSplats splats_at_points(const PointSet& points, std::span<const SplatStretch> stretches,
                                const RenderOptions& options, const PictureFrame& frame);

/// What SplatLayers hold, lit like other surfaces: rays of the picture find the layers of their pixel, those towards
/// lights meet discs.
class BlendedScene final : public PictureScene {
 public:
  /// What is passed must outlive the scene. The layers are those of the same camera and options, of what the options
  /// show.
  BlendedScene(const SplatLayers& layers, const RayScene& discs, const Camera& camera, const RenderOptions& options);
  void closest(const EyeRays& rays, std::span<std::optional<SurfacePoint>> points) const override;
  void blocked(std::span<const ShadowRay> rays, std::span<std::uint8_t> answers) const override;

 private:
  const SplatLayers& layers_;
  const RayScene& discs_;
  const Camera& camera_;
  const RenderOptions& options_;
};

/// Points that are drawn once or several times.
class SplatPicture {
 public:
  /// As splats_at_points. `options`: those of the pictures, whose colour the splats have.
  SplatPicture(const PointSet& points, std::span<const SplatStretch> stretches, const RenderOptions& options);
  ~SplatPicture();
  SplatPicture(const SplatPicture&) = delete;
  SplatPicture& operator=(const SplatPicture&) = delete;

  std::size_t size() const;
  /// Lit as render_mesh() does; does not depend on the number of threads. Throws ArgumentError for bad options.
  Image render(const RenderOptions& options, Progress& progress) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sansmesh::inline v1
