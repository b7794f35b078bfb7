// What a painter asks of whatever it paints.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/core/vec.h"
#include "sansmesh/render/camera.h"

namespace sansmesh {

/// The painter's coordinates: (x − center) / size.
struct PictureFrame {
  Vec3 center;
  double size = 1;
  Vec3f to_picture(const Vec3& x) const { return Vec3f((x - center) / size); }
  Vec3f to_surface(const Vec3f& x) const { return Vec3f(Vec3(x) * size + center); }
};

/// Where a ray from the eye ends.
struct SurfacePoint {
  float distance = 0;  ///< from the eye to the surface itself: what is in front of what goes by it
  Vec3f position;      ///< just off the surface on the viewer's side: further rays start here
  Vec3f normal;        ///< for shading, unit, on the viewer's side
  Vec3f color;         ///< share of light reflected, linear
  float gloss = 1;     ///< strength of highlights
  Vec3f beyond{};      ///< light that mirrors and clear bodies send, linear; comes on top
  float opacity = 1;   ///< share of the light from behind that is kept back; counts in layers() only
  Vec3f vector{};      ///< of a flow there; 0 where there is none
};

struct ShadowRay {
  Vec3f origin, direction;
  float length;
};

/// Safe from several threads. Rays come in batches, neighbours in the picture in neighbouring slots. Sizes must agree.
class PictureScene {
 public:
  virtual ~PictureScene() = default;
  /// The first point of the surface along unit directions from the eye.
  virtual void closest(const Vec3f& eye, std::span<const Vec3f> directions,
                       std::span<std::optional<SurfacePoint>> points) const = 0;
  /// All that is to be seen along the same directions, front to back: of direction i points[first[i]] up to
  /// points[first[i + 1]], in place of what both held. Of scenes that are opaque the first point.
  virtual void layers(const Vec3f& eye, std::span<const Vec3f> directions, std::vector<std::size_t>& first,
                      std::vector<SurfacePoint>& points) const;
  /// 1 where the surface is in the way, else 0.
  virtual void blocked(std::span<const ShadowRay> rays, std::span<std::uint8_t> answers) const = 0;
};

/// Opacity of a sheet that has `opacity` seen at right angles, at a cosine between ray and normal: a ray at an angle
/// has a longer way through it.
float sheet_opacity(float opacity, float cosine);
/// Light from behind that is worth looking for, and so many sheets at most.
constexpr float kLeastThrough = 0.002f;
constexpr int kMostSheets = 256;

/// Makes a surface ready for a picture with this frame and camera (in the frame's coordinates).
using PictureSurface = std::function<std::unique_ptr<PictureScene>(const PictureFrame& frame, const Camera& camera)>;

}  // namespace sansmesh
