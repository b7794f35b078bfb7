// The light that pictures are taken in, and what stands behind the subject.
#pragma once

#include "sansmesh/render/scene/camera.h"
#include "sansmesh/render_options.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// sRGB 0..1 → linear light.
Vec3f linear_color(const Vec3f& srgb);

/// Highlights roll off instead of clipping.
Vec3f shoulder(const Vec3f& light);

inline Vec3f product(const Vec3f& a, const Vec3f& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline Vec3f mix(const Vec3f& a, const Vec3f& b, float t) { return a + (b - a) * t; }

/// Mirrored light at a cosine between the normal and the direction half-way between eye and light: about its 36th
/// power, by products.
inline float highlight(float cosine) {
  const float x = cosine > 0 ? cosine : 0, x2 = x * x, x4 = x2 * x2, x8 = x4 * x4, x16 = x8 * x8;
  return 0.10f * x4 * x16 * x16;
}

/// Lights go with the camera: any view is lit from its upper left. Light in front of a white card: 1 is white in the
/// picture.
struct Lighting {
  explicit Lighting(const Camera& camera);
  static constexpr Vec3f kKey{0.90f, 0.845f, 0.77f}, kFill{0.07f, 0.08f, 0.10f};
  static constexpr Vec3f kSkyHigh{0.38f, 0.41f, 0.45f}, kSkyLow{0.12f, 0.105f, 0.09f};

  /// Of the sky around a direction, seen unblocked.
  Vec3f sky_light(const Vec3f& direction) const { return mix(kSkyLow, kSkyHigh, 0.5f + 0.5f * dot(direction, sky)); }
  /// Of the whole sky on a surface.
  Vec3f ambient(const Vec3f& normal) const { return mix(kSkyLow, kSkyHigh, 0.5f + dot(normal, sky) / 3); }
  /// Mirrored key light, and sky at grazing angles; `direction` leads from the eye to the surface.
  float shine(const Vec3f& normal, const Vec3f& direction) const;
  float sheen(const Vec3f& normal, const Vec3f& direction) const;

  Vec3f key, fill, sky;  ///< unit, towards the lights
};

/// Behind the subject, at a place of the picture from 0 (left, top) to 1; beyond, as at its rim.
Vec3f background_light(const RenderOptions& options, float x, float y);

}  // namespace sansmesh::inline v1
