#include "sansmesh/render/pixel.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/render/lighting.h"

namespace sansmesh {
namespace {

/// Linear light → byte of sRGB, rounded up from `threshold` on.
std::uint8_t srgb_byte(float c, float threshold = 0.5f) {
  c = std::clamp(c, 0.0f, 1.0f);
  const float s = c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(255 * s + 1 - threshold);
}

/// Light that comes from the surface.
Vec3f surface_light(const Pixel& pixel) {
  const Vec3f light =
      pixel.ambient + Lighting::kFill * (pixel.fill * pixel.open) + Lighting::kKey * (pixel.facing * pixel.lit);
  const Vec3f gloss = Lighting::kKey * (pixel.shine * pixel.lit) + Lighting::kSkyHigh * (pixel.sheen * pixel.open);
  const Vec3f bright = product(pixel.color, light) + gloss;
  return shoulder(bright) + pixel.beyond;
}

}  // namespace

std::array<std::uint8_t, 4> opaque_color(const Pixel& pixel, const Vec3f& background, float threshold) {
  const float beside = 1 - pixel.cover;
  const Vec3f color = surface_light(pixel) * pixel.cover + background * (beside * (1 - pixel.dark));
  return {srgb_byte(color.x, threshold), srgb_byte(color.y, threshold), srgb_byte(color.z, threshold), 255};
}

std::array<std::uint8_t, 4> transparent_color(const Pixel& pixel) {
  const float beside = 1 - pixel.cover;
  const float alpha = std::min(1.0f, pixel.cover + beside * pixel.dark);
  if (!(alpha > 0)) return {0, 0, 0, 0};
  const Vec3f color = surface_light(pixel) * (pixel.cover / alpha);
  return {srgb_byte(color.x), srgb_byte(color.y), srgb_byte(color.z),
          static_cast<std::uint8_t>(std::lround(255 * alpha))};
}

}  // namespace sansmesh
