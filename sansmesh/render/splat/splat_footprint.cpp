#include "sansmesh/render/splat/splat_footprint.h"

#include <algorithm>
#include <cmath>

namespace sansmesh::inline v1 {
namespace {

struct PixelStep {
  float x, y;
};

}  // namespace

std::optional<SplatFootprint> splat_footprint(const Camera& camera, int width, int height, const Vec3f& center,
                                              const Vec3f& a, const Vec3f& b, float filter) {
  const Vec3f d = center - camera.position;
  const float right = dot(d, camera.right), up = dot(d, camera.up), depth = -dot(d, camera.backward);
  const float wide = std::sqrt(std::max(squared_norm(a), squared_norm(b)));
  if (!(depth > (camera.parallel ? 0 : wide))) return std::nullopt;
  const float scale_x = 0.5f * static_cast<float>(width) / camera.half_width,
              scale_y = 0.5f * static_cast<float>(height) / camera.half_height;
  const float shrink = 1 / camera.shrink(depth);
  const auto derivative = [&](const Vec3f& t) {
    // Approaching points move away from the picture's centre.
    const float nearer = camera.parallel ? 0 : dot(t, camera.backward) * shrink;
    return PixelStep{scale_x * shrink * (dot(t, camera.right) + right * nearer),
                     -scale_y * shrink * (dot(t, camera.up) + up * nearer)};
  };
  const PixelStep u = derivative(a), v = derivative(b);
  const float least = filter * filter;
  const float vxx = u.x * u.x + v.x * v.x + least, vyy = u.y * u.y + v.y * v.y + least, vxy = u.x * u.y + v.x * v.y;
  // The determinant as a sum of squares, without cancellation if the ellipse is a line.
  const float area = u.x * v.y - v.x * u.y;
  const float det = area * area + least * (vxx + vyy - least);
  if (!(det > 0) || !std::isfinite(det)) return std::nullopt;
  SplatFootprint f;
  f.x = 0.5f * static_cast<float>(width) + scale_x * shrink * right;
  f.y = 0.5f * static_cast<float>(height) - scale_y * shrink * up;
  f.xx = vyy / det, f.xy = -vxy / det, f.yy = vxx / det;
  f.peak = std::abs(area) / std::sqrt(det);
  f.reach_x = kSplatCut * std::sqrt(vxx), f.reach_y = kSplatCut * std::sqrt(vyy);
  return f;
}

}  // namespace sansmesh::inline v1
