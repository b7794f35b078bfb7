#include "sansmesh/render/surface/surface_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sansmesh/core/median.h"
#include "sansmesh/points/statistics/spacing.h"

namespace sansmesh::inline v1 {
namespace {

constexpr float kShadowOffset = 2e-4f;     // share of the diagonal: hides the rounding of floats
constexpr float kOffSurface = 0.02f;       // share of the ball's radius: many tolerances off the surface
constexpr double kDiscWidth = 1.3;         // discs at random positions leave exp(−π 1.3²) = 0.5 % uncovered
constexpr float kParallelField = 0.27f;    // half the field of view of the background for parallel rays, a slope
constexpr float kLeastWeight = 1.0f / 32;  // least share of light that is traced

/// Reflected share of a clear body (Fresnel, unpolarised). `cosine`: between ray and normal, 0..1; `ratio`: index on
/// the ray's side over the index beyond.
float mirrored_share(float cosine, float ratio) {
  const float square = 1 - ratio * ratio * (1 - cosine * cosine);
  if (square <= 0) return ratio > 1 ? 1 : 0;  // total reflection, or a ray along the surface without refraction
  const float beyond = std::sqrt(square);
  const float across = (ratio * cosine - beyond) / (ratio * cosine + beyond);
  const float along = (cosine - ratio * beyond) / (cosine + ratio * beyond);
  return 0.5f * (across * across + along * along);
}

Vec3f mirrored(const Vec3f& direction, const Vec3f& normal) {
  return normalized(direction - 2 * dot(direction, normal) * normal);
}

}  // namespace

/// A secondary ray from the surface, for a ray from the eye.
struct SurfaceScene::Path {
  std::uint32_t slot;
  float weight;
};

struct SurfaceScene::Scratch {
  std::vector<CastRay> rays, next_rays;
  std::vector<CastHit> hits;
  std::vector<Path> paths, next_paths;
  std::vector<Vec3> positions;
  std::vector<Vec3f> colors;  // linear, of all hits in sequence
  std::vector<ShadowRay> shadow_rays;
  std::vector<std::uint8_t> in_shadow;
};

SurfaceScene::SurfaceScene(const SurfaceCaster& caster, const PictureFrame& frame, const Camera& camera,
                           const ColorField* colors, const SurfaceRenderOptions& options)
    : caster_(caster),
      frame_(frame),
      camera_(camera),
      colors_(options.picture.look.use_colors ? colors : nullptr),
      options_(options),
      lighting_(camera),
      color_(linear_color(options.picture.look.surface_color)),
      own_(static_cast<float>(std::max(0.0, 1 - options.reflection - options.transmission))),
      mirror_(static_cast<float>(options.reflection)),
      clear_(static_cast<float>(options.transmission)),
      index_(static_cast<float>(options.refraction_index)) {
  // Highlights are also mirrored light: glass has those of other smooth bodies, but none without refraction.
  const float straight = mirrored_share(1, index_);
  gloss_ = (1 - clear_) + clear_ * std::min(1.0f, straight / 0.04f);
  const bool asks =
      options.picture.look.shadows || options.picture.look.ground || options.picture.quality.occlusion_rays > 0;
  if (asks && !options.exact_shadows) discs_ = shadow_discs();
}

/// Discs around the samples: soft shadows do not need the exact surface.
std::optional<RayScene> SurfaceScene::shadow_discs() {
  const BallUnion& balls = caster_.balls();
  std::vector<Vec3f> positions(balls.centers.size()), normals(balls.centers.size());
  caster_.surface_points(positions, normals);
  PointSet cloud;
  cloud.positions = balls.centers;
  std::vector<float> sorted = balls.radii;
  const double radius = median(sorted), spacing = estimate_spacing(cloud);
  disc_over_ball_ = static_cast<float>(std::min(1.0, kDiscWidth * spacing / radius));
  std::vector<float> radii;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (normals[i] == Vec3f{}) continue;
    positions[kept] = frame_.to_picture(Vec3(positions[i]));
    normals[kept++] = normals[i];
    radii.push_back(disc_over_ball_ * balls.radii[i] / static_cast<float>(frame_.size));
  }
  if (kept == 0) {  // no discs to represent the surface
    disc_over_ball_ = kOffSurface;
    return std::nullopt;
  }
  positions.resize(kept);
  normals.resize(kept);
  return RayScene::discs(positions, normals, radii);
}

/// Position off the surface in the painter's coordinates, on the side of `toward`.
Vec3f SurfaceScene::off_surface(const CastHit& hit, const Vec3f& toward, float share) const {
  return frame_.to_picture(hit.position) +
         toward * (kShadowOffset + share * hit.radius / static_cast<float>(frame_.size));
}

void SurfaceScene::color_hits(Scratch& s) const {
  s.colors.clear();
  if (colors_ == nullptr) return;
  s.positions.clear();
  for (const CastHit& hit : s.hits)
    if (hit.hit) s.positions.push_back(hit.position);
  s.colors.resize(s.positions.size());
  colors_->evaluate(s.positions, s.colors);
  for (Vec3f& c : s.colors)
    c = linear_color({std::clamp(c.x, 0.0f, 1.0f), std::clamp(c.y, 0.0f, 1.0f), std::clamp(c.z, 0.0f, 1.0f)});
}

void SurfaceScene::closest(const EyeRays& rays, std::span<std::optional<SurfacePoint>> points) const {
  Scratch s;
  s.rays.reserve(rays.size());
  const std::span<const Vec3f> directions = rays.directions;
  const auto size = static_cast<float>(frame_.size);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    s.rays.push_back({frame_.to_surface(rays.origin(i)), directions[i]});
    if (!rays.near.empty()) s.rays.back().near = rays.near[i] * size;
    if (!rays.far.empty()) s.rays.back().far = rays.far[i] * size;
  }
  s.hits.resize(s.rays.size());
  caster_.cast(s.rays, s.hits);
  color_hits(s);

  const float share = options_.exact_shadows ? kOffSurface : disc_over_ball_;
  std::size_t hit_number = 0;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const CastHit& hit = s.hits[i];
    points[i].reset();
    if (!hit.hit) continue;
    const Vec3f normal = dot(hit.normal, directions[i]) > 0 ? -hit.normal : hit.normal;
    const Vec3f color = s.colors.empty() ? color_ : s.colors[hit_number];
    points[i] = SurfacePoint{static_cast<float>(static_cast<double>(hit.distance) / frame_.size),
                             off_surface(hit, normal, share), normal, color * own_, gloss_};
    ++hit_number;
    split(hit, directions[i], 1, i, s);
  }
  for (int bounce = 0; bounce < options_.bounces && !s.next_rays.empty(); ++bounce) follow(s, points);
  // Paths that remain after the last bounce see the surroundings.
  for (std::size_t k = 0; k < s.next_rays.size(); ++k)
    points[s.next_paths[k].slot]->beyond += environment(s.next_rays[k].direction) * s.next_paths[k].weight;
}

/// Continues with the reflected and the transmitted ray.
void SurfaceScene::split(const CastHit& hit, const Vec3f& direction, float weight, std::uint32_t slot,
                         Scratch& s) const {
  const bool entering = dot(hit.normal, direction) < 0;
  const Vec3f normal = entering ? hit.normal : -hit.normal;
  const float cosine = std::min(1.0f, -dot(normal, direction));
  const float ratio = entering ? 1 / index_ : index_;
  const float fresnel = clear_ > 0 ? mirrored_share(cosine, ratio) : 0;
  const auto send = [&](const Vec3f& along, const Vec3f& side, float part) {
    if (!(part > 0)) return;
    const Vec3f from(hit.position + Vec3(side) * static_cast<double>(kOffSurface * hit.radius));
    s.next_rays.push_back({from, along});
    s.next_paths.push_back({slot, part});
  };
  send(mirrored(direction, normal), normal, weight * (mirror_ + clear_ * fresnel));
  if (clear_ > 0 && fresnel < 1) {
    const float beyond = std::sqrt(std::max(0.0f, 1 - ratio * ratio * (1 - cosine * cosine)));
    send(normalized(direction * ratio + normal * (ratio * cosine - beyond)), -normal, weight * clear_ * (1 - fresnel));
  }
}

/// One bounce of all paths.
void SurfaceScene::follow(Scratch& s, std::span<std::optional<SurfacePoint>> points) const {
  s.rays.clear();
  s.paths.clear();
  for (std::size_t k = 0; k < s.next_rays.size(); ++k) {
    if (s.next_paths[k].weight < kLeastWeight) {  // too weak to trace
      points[s.next_paths[k].slot]->beyond += environment(s.next_rays[k].direction) * s.next_paths[k].weight;
      continue;
    }
    s.rays.push_back(s.next_rays[k]);
    s.paths.push_back(s.next_paths[k]);
  }
  s.next_rays.clear();
  s.next_paths.clear();
  s.hits.resize(s.rays.size());
  caster_.cast(s.rays, s.hits);
  color_hits(s);

  const auto facing_normal = [&](std::size_t k) {
    return dot(s.hits[k].normal, s.rays[k].direction) > 0 ? -s.hits[k].normal : s.hits[k].normal;
  };
  s.shadow_rays.clear();
  const bool shadows = options_.picture.look.shadows && own_ > 0;
  if (shadows) {
    const float share = options_.exact_shadows ? kOffSurface : disc_over_ball_;
    for (std::size_t k = 0; k < s.hits.size(); ++k)
      if (s.hits[k].hit)
        s.shadow_rays.push_back(
            {off_surface(s.hits[k], facing_normal(k), share), lighting_.key, std::numeric_limits<float>::infinity()});
    s.in_shadow.resize(s.shadow_rays.size());
    blocked(s.shadow_rays, s.in_shadow);
  }
  std::size_t hit_number = 0;
  for (std::size_t k = 0; k < s.hits.size(); ++k) {
    const CastHit& hit = s.hits[k];
    const Path path = s.paths[k];
    Vec3f& beyond = points[path.slot]->beyond;
    if (!hit.hit) {
      beyond += environment(s.rays[k].direction) * path.weight;
      continue;
    }
    const std::size_t number = hit_number++;
    if (own_ > 0) {
      const Vec3f normal = facing_normal(k), color = s.colors.empty() ? color_ : s.colors[number];
      const float lit = shadows && s.in_shadow[number] ? 0.0f : 1.0f;
      const Vec3f light = lighting_.ambient(normal) + Lighting::kFill * std::max(0.0f, dot(normal, lighting_.fill)) +
                          Lighting::kKey * (lit * std::max(0.0f, dot(normal, lighting_.key)));
      beyond += shoulder(product(color, light)) * (own_ * path.weight);
    }
    split(hit, s.rays[k].direction, path.weight, path.slot, s);
  }
}

/// The background in the camera's field of view, and a bright sky elsewhere.
Vec3f SurfaceScene::environment(const Vec3f& direction) const {
  if (options_.environment) return options_.environment(direction);
  const float ahead = -dot(direction, camera_.backward);
  const Vec3f sky = lighting_.sky_light(direction) * 2;
  if (ahead <= 0) return sky;
  // Parallel rays see the background like those of a narrow field of view.
  const float wide = camera_.parallel ? kParallelField / std::max(camera_.half_width, camera_.half_height) : 1;
  const float x = dot(direction, camera_.right) / (ahead * wide * camera_.half_width);
  const float y = dot(direction, camera_.up) / (ahead * wide * camera_.half_height);
  const float t = std::min(1.0f, ahead / 0.5f);
  return mix(sky, background_light(options_.picture, 0.5f + 0.5f * x, 0.5f - 0.5f * y), t * t * (3 - 2 * t));
}

void SurfaceScene::blocked(std::span<const ShadowRay> rays, std::span<std::uint8_t> answers) const {
  if (discs_) {
    for (std::size_t i = 0; i < rays.size(); ++i)
      answers[i] = discs_->blocked(rays[i].origin, rays[i].direction, rays[i].length, rays[i].near);
    return;
  }
  std::vector<CastRay> casts;
  casts.reserve(rays.size());
  const auto size = static_cast<float>(frame_.size);
  for (const ShadowRay& r : rays)
    casts.push_back({frame_.to_surface(r.origin), r.direction, r.near * size, r.length * size});
  std::vector<CastHit> hits(casts.size());
  caster_.cast(casts, hits);
  for (std::size_t i = 0; i < rays.size(); ++i) answers[i] = hits[i].hit;
}

}  // namespace sansmesh::inline v1
