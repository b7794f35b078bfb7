#include "sansmesh/render/mesh_preview.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/render/preview_scene.h"

namespace sansmesh {
namespace {

constexpr int kTile = 32;
constexpr double kMargin = 0.1;          // share of the picture's half left free around the subject
constexpr float kOcclusionReach = 0.5f;  // of the diagonal: rooms are lit inside, too
constexpr float kLightSpread = 0.13f;    // radius of the key light as seen from the subject, radians

// Light in front of a white card: 1 is white in the picture.
const Vec3f kKey{0.74f, 0.70f, 0.65f}, kFill{0.07f, 0.09f, 0.12f};
const Vec3f kSkyHigh{0.62f, 0.66f, 0.72f}, kSkyLow{0.16f, 0.15f, 0.14f};
constexpr float kBounce = 0.22f;  // light that what blocks the sky sends instead

Vec3f product(const Vec3f& a, const Vec3f& b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
Vec3f mix(const Vec3f& a, const Vec3f& b, float t) { return a + (b - a) * t; }
float fraction(float x) { return x - std::floor(x); }

/// Linear light → byte of sRGB; highlights roll off instead of clipping.
std::uint8_t srgb_byte(float c) {
  c = std::clamp(c, 0.0f, 1.0f);
  const float s = c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1 / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::lround(255 * s));
}

float shoulder(float c) {
  constexpr float kKnee = 0.75f, kRoom = 1 - kKnee;
  return c <= kKnee ? c : kKnee + kRoom * (1 - std::exp((kKnee - c) / kRoom));
}

/// Points of the unit square, evenly spread from any index on: the additive recurrence by the plastic number (Roberts
/// 2018), started elsewhere in each pixel so that the error is fine grain, not bands.
struct Pattern {
  float u0 = 0, v0 = 0;
  Pattern(int x, int y) {
    const auto fx = static_cast<float>(x % 4096), fy = static_cast<float>(y % 4096);
    u0 = fraction(52.9829189f * fraction(0.06711056f * fx + 0.00583715f * fy));
    v0 = fraction(52.9829189f * fraction(0.00583715f * fx + 0.06711056f * fy + 0.37f));
  }
  float u(int i) const { return fraction(u0 + 0.75487767f * static_cast<float>(i)); }
  float v(int i) const { return fraction(v0 + 0.56984029f * static_cast<float>(i)); }
};

/// Direction around the unit vector n, distributed like the cosine.
Vec3f around(const Vec3f& n, float u, float v) {
  Vec3f t, b;
  tangent_frame(n, t, b);
  const float r = std::sqrt(u), angle = 2 * std::numbers::pi_v<float> * v;
  return r * std::cos(angle) * t + r * std::sin(angle) * b + std::sqrt(1 - u) * n;
}

/// Premultiplied linear colour and coverage.
struct Sample {
  Vec3f color;
  float alpha = 0;
};

class Painter {
 public:
  Painter(const PreviewScene& scene, const Camera& camera, const RenderOptions& options)
      : scene_(scene), camera_(camera), options_(options) {
    up_ = options.up == UpAxis::z ? Vec3f{0, 0, 1} : Vec3f{0, 1, 0};
    // The lights go with the camera: any view is lit from its upper left, as pictures are read.
    key_ = normalized(-0.55f * camera.right + 0.75f * camera.up + 0.62f * camera.backward);
    fill_ = normalized(0.8f * camera.right + 0.1f * camera.up + 0.5f * camera.backward);
    sky_ = normalized(camera.up + 0.5f * camera.backward);
  }

  /// Lets shadows fall on the plane through the lowest point.
  void add_ground(std::span<const Vec3f> points, float radius) {
    Box3f box;
    for (const Vec3f& p : points) box.extend(p);
    const int axis = options_.up == UpAxis::z ? 2 : 1;
    floor_ = box.lower[axis] - radius;
    foot_ = box.center();
    foot_[axis] = floor_;
    Vec3f half = box.size() * 0.5f;
    half[axis] *= 0.5f;
    shadow_reach_ = 1.6f * norm(half) + radius;
    // From below or along the ground there is nothing that a shadow could fall on.
    ground_ = dot(camera_.position, up_) > floor_ + 0.02f && dot(key_, up_) > 0.1f;
  }

  Image paint(Progress& progress) const {
    Image image(options_.width, options_.height);
    const int across = (options_.width + kTile - 1) / kTile, down = (options_.height + kTile - 1) / kTile;
    const auto tiles = static_cast<std::size_t>(across) * static_cast<std::size_t>(down);
    progress.begin("rendering", tiles);
    parallel_for(0, tiles, 1, [&](std::size_t tile) {
      const int left = static_cast<int>(tile) % across * kTile, top = static_cast<int>(tile) / across * kTile;
      for (int y = top; y < std::min(top + kTile, options_.height); ++y)
        for (int x = left; x < std::min(left + kTile, options_.width); ++x) image.at(x, y) = pixel(x, y);
      progress.advance();
    });
    progress.finish();
    return image;
  }

 private:
  std::array<std::uint8_t, 4> pixel(int x, int y) const {
    const int n = options_.samples;
    const Pattern pattern(x, y);
    Sample sum;
    for (int s = 0; s < n * n; ++s) {
      const float fx = static_cast<float>(x) + (static_cast<float>(s % n) + 0.5f) / static_cast<float>(n);
      const float fy = static_cast<float>(y) + (static_cast<float>(s / n) + 0.5f) / static_cast<float>(n);
      const Vec3f direction = camera_.direction(2 * fx / static_cast<float>(options_.width) - 1,
                                                1 - 2 * fy / static_cast<float>(options_.height));
      const Sample own = sample(direction, pattern, s);
      sum.color += own.color;
      sum.alpha += own.alpha;
    }
    const float share = 1 / static_cast<float>(n * n);
    return finish({sum.color * share, sum.alpha * share}, x, y);
  }

  std::array<std::uint8_t, 4> finish(const Sample& sample, int x, int y) const {
    if (options_.background == RenderOptions::Background::transparent) {
      if (!(sample.alpha > 0)) return {0, 0, 0, 0};
      const Vec3f color = sample.color / sample.alpha;
      return {srgb_byte(color.x), srgb_byte(color.y), srgb_byte(color.z),
              static_cast<std::uint8_t>(std::lround(255 * std::min(sample.alpha, 1.0f)))};
    }
    const Vec3f color = sample.color + background(x, y) * (1 - sample.alpha);
    return {srgb_byte(color.x), srgb_byte(color.y), srgb_byte(color.z), 255};
  }

  Vec3f background(int x, int y) const {
    if (options_.background == RenderOptions::Background::solid) return linear_color(options_.background_color);
    // A pool of light behind the subject.
    const float dx = (static_cast<float>(x) + 0.5f) / static_cast<float>(options_.width) - 0.5f;
    const float dy = (static_cast<float>(y) + 0.5f) / static_cast<float>(options_.height) - 0.55f;
    const float t = std::min(1.0f, 1.9f * (dx * dx + dy * dy));
    return mix(Vec3f{0.93f, 0.935f, 0.94f}, Vec3f{0.60f, 0.63f, 0.67f}, t);
  }

  Sample sample(const Vec3f& direction, const Pattern& pattern, int index) const {
    if (const auto point = scene_.closest(camera_.position, direction))
      return {shade(*point, direction, pattern, index), 1};
    const float descent = dot(direction, up_);
    if (!ground_ || descent > -1e-3f) return {};
    const float distance = (floor_ - dot(camera_.position, up_)) / descent;
    return {{}, ground_shadow(camera_.position + distance * direction, pattern, index)};
  }

  Vec3f toward_key(const Pattern& pattern, int index) const {
    Vec3f t, b;
    tangent_frame(key_, t, b);
    const float r = kLightSpread * std::sqrt(pattern.u(index)),
                angle = 2 * std::numbers::pi_v<float> * pattern.v(index);
    return normalized(key_ + r * std::cos(angle) * t + r * std::sin(angle) * b);
  }

  bool in_key_shadow(const Vec3f& from, const Pattern& pattern, int index) const {
    return scene_.blocked(from, toward_key(pattern, index), std::numeric_limits<float>::infinity());
  }

  /// Light from all around that falls on a surface with this normal, and the share that is not blocked.
  Vec3f ambient(const SurfacePoint& point, const Pattern& pattern, int index, float& open) const {
    const int rays = options_.occlusion_rays;
    open = 1;
    if (rays == 0) return mix(kSkyLow, kSkyHigh, 0.5f + dot(point.normal, sky_) / 3);
    Vec3f sum;
    int free = 0;
    for (int k = 0; k < rays; ++k) {
      const int i = index * rays + k;
      const Vec3f direction = around(point.normal, pattern.u(i), pattern.v(i));
      const Vec3f light = mix(kSkyLow, kSkyHigh, 0.5f + 0.5f * dot(direction, sky_));
      if (scene_.blocked(point.position, direction, kOcclusionReach)) {
        sum += product(light, point.color) * kBounce;
      } else {
        sum += light;
        ++free;
      }
    }
    open = static_cast<float>(free) / static_cast<float>(rays);
    return sum / static_cast<float>(rays);
  }

  Vec3f shade(const SurfacePoint& point, const Vec3f& direction, const Pattern& pattern, int index) const {
    const Vec3f& n = point.normal;
    float open = 1;
    Vec3f light = ambient(point, pattern, index, open);
    light += kFill * (std::max(0.0f, dot(n, fill_)) * open);
    Vec3f gloss;
    const float facing = dot(n, key_);
    if (facing > 0 && !(options_.shadows && in_key_shadow(point.position, pattern, index))) {
      light += kKey * facing;
      const Vec3f half = normalized(key_ - direction);
      gloss += kKey * (0.10f * std::pow(std::max(0.0f, dot(n, half)), 36.0f));
    }
    const float grazing = 1 - std::clamp(-dot(n, direction), 0.0f, 1.0f);
    gloss += kSkyHigh * (0.10f * open * grazing * grazing * grazing * grazing);
    const Vec3f color = product(point.color, light) + gloss;
    return {shoulder(color.x), shoulder(color.y), shoulder(color.z)};
  }

  /// How much darker the ground is for the subject standing on it, 0..1.
  float ground_shadow(const Vec3f& at, const Pattern& pattern, int index) const {
    const float d = norm(at - foot_) / shadow_reach_;
    if (d >= 1) return 0;
    const float fade = (1 - d * d) * (1 - d * d);
    float dark = in_key_shadow(at, pattern, index) ? 0.38f : 0.0f;
    if (options_.occlusion_rays > 0) {
      int blocked = 0;
      for (int k = 0; k < options_.occlusion_rays; ++k) {
        const int i = index * options_.occlusion_rays + k;
        blocked += scene_.blocked(at, around(up_, pattern.u(i), pattern.v(i)), kOcclusionReach);
      }
      dark += 0.5f * static_cast<float>(blocked) / static_cast<float>(options_.occlusion_rays);
    }
    return dark * fade;
  }

  const PreviewScene& scene_;
  const Camera& camera_;
  const RenderOptions& options_;
  Vec3f up_, key_, fill_, sky_, foot_;
  float floor_ = 0, shadow_reach_ = 1;
  bool ground_ = false;
};

void check_range(const char* name, double value, double lowest, double highest) {
  if (value >= lowest && value <= highest) return;
  const auto shown = [](double v) {
    std::string text = std::to_string(v);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text;
  };
  throw ArgumentError(std::string(name) + " must be from " + shown(lowest) + " to " + shown(highest) + ", not " +
                      (std::isfinite(value) ? shown(value) : std::to_string(value)));
}

void check_color(const char* name, const Vec3f& color) {
  for (std::size_t k = 0; k < 3; ++k) check_range(name, static_cast<double>(color[k]), 0, 1);
}

}  // namespace

void RenderOptions::validate() const {
  check_range("width", width, 1, 16384);
  check_range("height", height, 1, 16384);
  check_range("view.azimuth", view.azimuth, -3600, 3600);
  check_range("view.elevation", view.elevation, -90, 90);
  check_range("field_of_view", field_of_view, 1, 120);
  check_color("background_color", background_color);
  check_color("surface_color", surface_color);
  check_range("samples", samples, 1, 8);
  check_range("occlusion_rays", occlusion_rays, 0, 64);
  if (point_radius && !(*point_radius > 0 && std::isfinite(*point_radius)))
    throw ArgumentError("point_radius must be positive, not " + std::to_string(*point_radius));
}

Image render_mesh(const TriangleMesh& mesh, const RenderOptions& options, Progress& progress) {
  options.validate();
  Subject subject = make_subject(mesh, options);
  const float radius = subject.radius;
  const Camera camera = frame_camera(subject.mesh.vertices, options.view, options.up, options.field_of_view,
                                     static_cast<double>(options.width) / options.height, kMargin, radius);
  const PreviewScene scene(std::move(subject), options, camera.backward);
  Painter painter(scene, camera, options);
  if (options.ground) painter.add_ground(scene.points(), radius);
  return painter.paint(progress);
}

Image render_mesh(const TriangleMesh& mesh, const RenderOptions& options) {
  Progress progress;
  return render_mesh(mesh, options, progress);
}

}  // namespace sansmesh
