// Scene of a surface without a mesh: lit, reflecting, refracting.
#pragma once

#include <optional>
#include <span>

#include "sansmesh/field/color_field.h"
#include "sansmesh/render/scene/lighting.h"
#include "sansmesh/render/scene/picture_scene.h"
#include "sansmesh/render/scene/ray_scene.h"
#include "sansmesh/render/surface/surface_caster.h"
#include "sansmesh/render_options.h"

namespace sansmesh::inline v1 {

class SurfaceScene : public PictureScene {
 public:
  /// All arguments must outlive the scene; `colors` may be null. `camera` in the painter's coordinates.
  SurfaceScene(const SurfaceCaster& caster, const PictureFrame& frame, const Camera& camera, const ColorField* colors,
               const SurfaceRenderOptions& options);
  void closest(const EyeRays& rays, std::span<std::optional<SurfacePoint>> points) const override;
  void blocked(std::span<const ShadowRay> rays, std::span<std::uint8_t> answers) const override;

 private:
  struct Path;
  struct Scratch;
  void color_hits(Scratch& scratch) const;
  void split(const CastHit& hit, const Vec3f& direction, float weight, std::uint32_t slot, Scratch& scratch) const;
  void follow(Scratch& scratch, std::span<std::optional<SurfacePoint>> points) const;
  Vec3f environment(const Vec3f& direction) const;
  Vec3f off_surface(const CastHit& hit, const Vec3f& toward, float share) const;
  std::optional<RayScene> shadow_discs();

  const SurfaceCaster& caster_;
  PictureFrame frame_;
  Camera camera_;
  const ColorField* colors_;
  const SurfaceRenderOptions& options_;
  Lighting lighting_;
  Vec3f color_;
  float own_ = 1, mirror_ = 0, clear_ = 0, index_ = 1;  // shares of light; refraction index
  float gloss_ = 1;
  float disc_over_ball_ = 0;
  std::optional<RayScene> discs_;
};

}  // namespace sansmesh::inline v1
