#include "sansmesh/render/scene/pixel.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/render/scene/lighting.h"
#include "sansmesh/render/scene/sample_pattern.h"

namespace sansmesh::inline v1 {
namespace {

/// Linear light → sRGB.
float srgb(float c) { return c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f; }

}  // namespace

Vec3f surface_light(const Pixel& pixel) {
  if (pixel.access >= 0) return shoulder(pixel.color * (pixel.access * pixel.open)) + pixel.beyond;
  const Vec3f light =
      pixel.ambient + Lighting::kFill * (pixel.fill * pixel.open) + Lighting::kKey * (pixel.facing * pixel.lit);
  const Vec3f gloss = Lighting::kKey * (pixel.shine * pixel.lit) + Lighting::kSkyHigh * (pixel.sheen * pixel.open);
  const Vec3f bright = product(pixel.color, light) + gloss;
  return shoulder(bright) + pixel.beyond;
}

Rgba opaque_color(const Pixel& pixel, const Vec3f& background) {
  const float beside = 1 - pixel.cover;
  Vec3f color = background * (beside * (1 - pixel.dark));
  if (pixel.cover > 0) color += surface_light(pixel) * pixel.cover;
  return {srgb(color.x), srgb(color.y), srgb(color.z), 1};
}

Rgba transparent_color(const Pixel& pixel) {
  const float beside = 1 - pixel.cover;
  const float alpha = std::min(1.0f, pixel.cover + beside * pixel.dark);
  if (!(alpha > 0)) return {0, 0, 0, 0};
  const Vec3f color = surface_light(pixel) * (pixel.cover / alpha);
  return {srgb(color.x), srgb(color.y), srgb(color.z), alpha};
}

Rgba dithered(const Rgba& color, int x, int y) {
  const float threshold = (static_cast<float>(pattern_part(x, y)) + 0.5f) / kParts;
  Rgba rounded;
  for (std::size_t k = 0; k < rounded.size(); ++k) rounded[k] = from_byte(to_byte(color[k], threshold));
  return rounded;
}

}  // namespace sansmesh::inline v1
