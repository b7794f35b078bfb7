// Lights and backgrounds of pictures.
#pragma once

#include "sansmesh/render/scene/camera.h"
#include "sansmesh/render_options.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// sRGB 0..1 → linear light.
Vec3f linear_color(const Vec3f& srgb);

/// Tone curve: compresses highlights instead of clipping them.
Vec3f shoulder(const Vec3f& light);

inline Vec3f product(const Vec3f& a, const Vec3f& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline Vec3f mix(const Vec3f& a, const Vec3f& b, float t) { return a + (b - a) * t; }

/// Mirrored light for a cosine between the normal and the half-way vector of eye and light: the 36th power of the
/// cosine, by products.
inline float highlight(float cosine) {
  const float x = cosine > 0 ? cosine : 0, x2 = x * x, x4 = x2 * x2, x8 = x4 * x4, x16 = x8 * x8;
  return 0.10f * x4 * x16 * x16;
}

/// Lights move with the camera and shine from its upper left. Light is relative to a white card: 1 is white in the
/// picture.
struct Lighting {
  explicit Lighting(const Camera& camera);
  static constexpr Vec3f kKey{0.90f, 0.845f, 0.77f}, kFill{0.07f, 0.08f, 0.10f};
  static constexpr Vec3f kSkyHigh{0.38f, 0.41f, 0.45f}, kSkyLow{0.12f, 0.105f, 0.09f};

  /// Unoccluded light of the sky around a direction.
  Vec3f sky_light(const Vec3f& direction) const { return mix(kSkyLow, kSkyHigh, 0.5f + 0.5f * dot(direction, sky)); }
  /// Light of the whole sky on a surface.
  Vec3f ambient(const Vec3f& normal) const { return mix(kSkyLow, kSkyHigh, 0.5f + dot(normal, sky) / 3); }
  /// Mirrored key light, and sky light at grazing angles; `direction` points from the eye to the surface.
  float shine(const Vec3f& normal, const Vec3f& direction) const;
  float sheen(const Vec3f& normal, const Vec3f& direction) const;

  Vec3f key, fill, sky;  ///< unit vectors towards the lights
};

/// Background at a point of the picture from 0 (left, top) to 1; beyond, as at the border.
Vec3f background_light(const RenderOptions& options, float x, float y);

}  // namespace sansmesh::inline v1
