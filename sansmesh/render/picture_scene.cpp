#include "sansmesh/render/picture_scene.h"

#include <algorithm>
#include <cmath>

namespace sansmesh {

float sheet_opacity(float opacity, float cosine) {
  constexpr float kSteepest = 0.1f;  // from which on it does not get thicker
  return 1 - std::pow(1 - opacity, 1 / std::max(kSteepest, std::abs(cosine)));
}

void PictureScene::layers(const Vec3f& eye, std::span<const Vec3f> directions, std::vector<std::size_t>& first,
                          std::vector<SurfacePoint>& points) const {
  std::vector<std::optional<SurfacePoint>> found(directions.size());
  closest(eye, directions, found);
  first.assign(1, 0);
  points.clear();
  for (const std::optional<SurfacePoint>& p : found) {
    if (p) points.push_back(*p);
    first.push_back(points.size());
  }
}

}  // namespace sansmesh
