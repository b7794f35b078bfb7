#include "sansmesh/render/scene/lighting.h"

#include <algorithm>
#include <cmath>

namespace sansmesh::inline v1 {
namespace {

float linear_channel(float c) { return c <= 0.04045f ? c / 12.92f : std::pow((c + 0.055f) / 1.055f, 2.4f); }

float shoulder(float c) {
  constexpr float kKnee = 0.75f, kRoom = 1 - kKnee;
  return c <= kKnee ? c : kKnee + kRoom * (1 - std::exp((kKnee - c) / kRoom));
}

}  // namespace

Vec3f linear_color(const Vec3f& srgb) {
  return {linear_channel(srgb.x), linear_channel(srgb.y), linear_channel(srgb.z)};
}

Vec3f shoulder(const Vec3f& light) { return {shoulder(light.x), shoulder(light.y), shoulder(light.z)}; }

Lighting::Lighting(const Camera& camera)
    : key(normalized(-0.50f * camera.right + 0.72f * camera.up + 0.72f * camera.backward)),
      fill(normalized(0.8f * camera.right + 0.1f * camera.up + 0.5f * camera.backward)),
      sky(normalized(camera.up + 0.5f * camera.backward)) {}

float Lighting::shine(const Vec3f& normal, const Vec3f& direction) const {
  return highlight(dot(normal, normalized(key - direction)));
}

float Lighting::sheen(const Vec3f& normal, const Vec3f& direction) const {
  const float grazing = 1 - std::clamp(-dot(normal, direction), 0.0f, 1.0f);
  return 0.10f * grazing * grazing * grazing * grazing;
}

Vec3f background_light(const RenderOptions& options, float x, float y) {
  if (options.look.effective_background().kind == Background::Kind::solid)
    return linear_color(options.look.effective_background().color);
  // A bright spot behind the subject.
  const float dx = x - 0.5f, dy = y - 0.55f;
  const float t = std::min(1.0f, 1.9f * (dx * dx + dy * dy));
  return mix(Vec3f{0.93f, 0.935f, 0.94f}, Vec3f{0.60f, 0.63f, 0.67f}, t);
}

}  // namespace sansmesh::inline v1
