// What a painter asks of whatever it paints.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "sansmesh/core/vec.h"

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
  Vec3f position;   ///< just off the surface on the viewer's side: further rays start here
  Vec3f normal;     ///< for shading, unit, on the viewer's side
  Vec3f color;      ///< share of light reflected, linear
  float gloss = 1;  ///< strength of highlights
  Vec3f beyond{};   ///< light that mirrors and clear bodies send, linear; comes on top
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
  /// 1 where the surface is in the way, else 0.
  virtual void blocked(std::span<const ShadowRay> rays, std::span<std::uint8_t> answers) const = 0;
};

}  // namespace sansmesh
