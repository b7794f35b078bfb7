#include "sansmesh/render/annotate/picture_crop.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "sansmesh/error.h"
#include "sansmesh/render/scene/color_space.h"
#include "sansmesh/render/scene/lighting.h"

namespace sansmesh::inline v1 {
namespace {

constexpr float kSamePaper = 5.0f / 255;  // more than dither and rounding change the background

}  // namespace

PixelBox picture_content(const Image& image, const RenderOptions& options, int margin) {
  const bool clear = options.look.effective_background().kind == Background::Kind::transparent;
  int left = image.width, top = image.height, right = -1, bottom = -1;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Rgba& p = image.at(x, y);
      bool content = p[3] > 0;
      if (!clear) {
        // Beside the picture its last column is repeated.
        const float u =
            (static_cast<float>(std::min(x, options.view.width - 1)) + 0.5f) / static_cast<float>(options.view.width);
        const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(options.view.height);
        const Vec3f paper = srgb_color(background_light(options, u, v));
        content = std::max({std::abs(p[0] - paper.x), std::abs(p[1] - paper.y), std::abs(p[2] - paper.z)}) > kSamePaper;
      }
      if (!content) continue;
      left = std::min(left, x), right = std::max(right, x);
      top = std::min(top, y), bottom = std::max(bottom, y);
    }
  if (right < 0) return {0, 0, image.width, image.height};
  left = std::max(0, left - margin), top = std::max(0, top - margin);
  right = std::min(image.width - 1, right + margin), bottom = std::min(image.height - 1, bottom + margin);
  return {left, top, right - left + 1, bottom - top + 1};
}

void check_crop(const PixelBox& part, int width, int height) {
  if (part.left < 0 || part.top < 0 || part.width < 1 || part.height < 1 || part.width > width - part.left ||
      part.height > height - part.top)
    throw ArgumentError("`crop` must be inside the picture, which has " + std::to_string(width) + " × " +
                        std::to_string(height) + " pixels");
}

Image cropped(const Image& image, const PixelBox& part) {
  check_crop(part, image.width, image.height);
  Image result(part.width, part.height);
  for (int y = 0; y < part.height; ++y)
    for (int x = 0; x < part.width; ++x) result.at(x, y) = image.at(part.left + x, part.top + y);
  return result;
}

}  // namespace sansmesh::inline v1
