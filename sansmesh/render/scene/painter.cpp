#include "sansmesh/render/scene/painter.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/core/boxes.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/field/curvature_field.h"
#include "sansmesh/image.h"
#include "sansmesh/render/annotate/line_drawing.h"
#include "sansmesh/render/annotate/picture_notes.h"
#include "sansmesh/render/scene/lighting.h"
#include "sansmesh/render/scene/pixel.h"
#include "sansmesh/render/scene/sample_pattern.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kTile = 64;
constexpr int kBlock = 17;               // pixels per batch of rays: a quarter of a tile with its rim
constexpr int kCoherent = 4;             // side of squares of consecutive pixels in a batch
constexpr float kOcclusionReach = 0.5f;  // share of the diagonal, so that interiors are lit, too
constexpr float kLightSpread = 0.13f;    // angular radius of the key light seen from the subject, radians
constexpr int kExposureRays = 4;         // per sample, if only accessibility is shown
constexpr float kBounce = 0.22f;         // light that occluders reflect instead of the sky
constexpr float kFarthestLook = 1e9f;    // distance of the picture's centre from the scene, whose size is about 1
constexpr double kMostZoom = 1e9;

/// Rays of a block, and their answers.
struct Batch {
  explicit Batch(const Camera& camera) : eye(camera) {}
  std::vector<std::pair<int, int>> pixels;
  CameraRays eye;
  std::vector<std::optional<SurfacePoint>> points;
  std::vector<ShadowRay> rays;
  std::vector<std::uint8_t> answers;
  std::vector<float> access;  // per pixel: accessibility factor of the curvature
};

/// Each pixel is computed twice: the first pass records its rays, ...
struct Recorder {
  std::vector<ShadowRay>& rays;
  bool operator()(const Vec3f& origin, const Vec3f& direction, float length) const {
    rays.push_back({origin, direction, length});
    return false;
  }
};
/// ... the second pass receives the answers. The recorded rays must not depend on the answers.
struct Replay {
  const std::uint8_t* next;
  bool operator()(const Vec3f& origin, const Vec3f& direction, float length) { return *next++ != 0; }
};

/// Factor of a mean curvature, relative to that of a ball with the radius of the accessibility; clamped to 0, which a
/// deep groove reaches if `most` is 1.
float curvature_factor(float curvature, float most) {
  if (std::isnan(curvature)) return 1;
  return std::max(0.0f, 1 + most * 2 / std::numbers::pi_v<float> * std::atan(curvature));
}

/// A box in the painter's coordinates.
Box3f box_in_picture(const Box3& box, const PictureFrame& frame) {
  return {frame.to_picture(box.lower), frame.to_picture(box.upper)};
}

/// Points that frame a picture: the given ones, or the corners of their box intersected with that of the options.
std::vector<Vec3f> shown_corners(std::span<const Vec3f> points, const PictureFrame& frame, const Box3& clip) {
  Box3f all;
  for (const Vec3f& p : points) all.extend(p);
  const Box3f box = common_part(box_in_picture(clip, frame), all);
  if (box.empty()) throw ArgumentError("`clip_box` contains no part of the scene");
  std::vector<Vec3f> corners;
  corners.reserve(8);
  for (int c = 0; c < 8; ++c) corners.push_back(box_corner(box, c));
  return corners;
}

/// Background of pure line drawings.
Image paper(const RenderOptions& options) {
  if (options.look.effective_background().kind == Background::Kind::transparent)
    return Image(options.view.width, options.view.height, {0, 0, 0, 0});
  const Vec3f c = options.look.effective_background().kind == Background::Kind::solid
                      ? options.look.effective_background().color
                      : Vec3f{1, 1, 1};
  return Image(options.view.width, options.view.height, {c.x, c.y, c.z, 1});
}

}  // namespace

Camera picture_camera(std::span<const Vec3f> points, const PictureFrame& frame, const RenderOptions& options,
                      float radius) {
  const bool steady = options.view.steady;
  const double aspect = static_cast<double>(options.view.width) / options.view.height;
  std::vector<Vec3f> corners;
  if (options.view.clip_box) {
    corners = shown_corners(points, frame, *options.view.clip_box);
    points = corners;
  }
  const Vec3f middle = corners.empty() ? Vec3f{} : (corners.front() + corners.back()) * 0.5f;
  double reach = radius;
  if (steady)
    for (const Vec3f& p : points) reach = std::max(reach, static_cast<double>(norm(p - middle)));
  Camera camera = frame_camera(steady ? std::span(&middle, 1) : points, options.view.direction, options.view.up,
                               options.view.field_of_view, aspect, kPictureMargin, reach, options.view.orthographic);
  double factor = options.view.zoom;
  if (options.view.look_at) {
    const Vec3f target = frame.to_picture(*options.view.look_at);
    // Floats cannot represent rays from farther away.
    if (!(norm(target - middle) <= kFarthestLook)) throw ArgumentError("`look_at` is too far away from the scene");
    look_at(camera, target);
    if (options.view.look_radius)
      factor = zoom_on_ball(camera, static_cast<double>(camera.project(target).depth),
                            *options.view.look_radius / frame.size, kPictureMargin);
  }
  if (!(factor >= 1 / kMostZoom && factor <= kMostZoom))
    throw ArgumentError(
        fmt::format("`look_radius` makes the picture {:.3g} times as large: from {:g} to {:g} is possible", factor,
                    1 / kMostZoom, kMostZoom));
  if (factor != 1) zoom(camera, factor);
  return camera;
}

Image paint_scene(const PictureScene& scene, const Camera& camera, const PictureFrame& frame,
                  const RenderOptions& options, bool smooth_light, std::span<const Vec3f> points, float below,
                  Progress& progress) {
  std::optional<ClippedScene> part;
  std::vector<Vec3f> corners;
  if (options.view.clip_box) {
    part.emplace(scene, box_in_picture(*options.view.clip_box, frame));
    corners = shown_corners(points, frame, *options.view.clip_box);
    points = corners;
  }
  const PictureScene& shown = part ? static_cast<const PictureScene&>(*part) : scene;
  using Lines = PictureLook::Lines;
  Image image;
  if (options.look.lines == Lines::only) {
    image = paper(options);
  } else {
    Painter painter(shown, camera, options, smooth_light);
    painter.set_frame(frame);
    if (options.look.ground) painter.add_ground(points, below);
    image = painter.paint(progress);
  }
  if (options.look.lines != Lines::none)
    draw_ink(image, line_ink(shown, camera, frame, options, progress), options.look.line_color);
  if (options.annotation.scale_bar)
    draw_scale_bar(image, frame, camera, options.annotation.input_length, *options.annotation.scale_bar);
  return image;
}

class Painter::Work {
 public:
  Work(const PictureScene& scene, const Camera& camera, const RenderOptions& options, bool smooth_light)
      : scene_(scene),
        camera_(camera),
        options_(options),
        lighting_(camera),
        up_frame_(options.view.up == UpAxis::z ? Vec3f{0, 0, 1} : Vec3f{0, 1, 0}),
        key_frame_(lighting_.key),
        sky_rays_(options.look.accessibility && options.quality.occlusion_rays > 0
                      ? std::max(kExposureRays, options.quality.occlusion_rays)
                      : options.quality.occlusion_rays),
        sky_reach_(options.look.accessibility ? static_cast<float>(*options.look.accessibility) : kOcclusionReach),
        spots_(spread_over_disc(kParts * options.quality.samples * options.quality.samples * std::max(1, sky_rays_))),
        footprint_(2 * camera.half_height / static_cast<float>(options.view.height)),
        rim_(smooth_light ? kSmooth : 0),
        paper_(opaque_color(Pixel{}, linear_color(options.look.effective_background().color))) {}

  /// Adds a ground plane for shadows, `below` under the lowest point.
  void add_ground(std::span<const Vec3f> points, float below) {
    Box3f box;
    for (const Vec3f& p : points) box.extend(p);
    const int axis = options_.view.up == UpAxis::z ? 2 : 1;
    floor_ = box.lower[axis] - below;
    foot_ = box.center();
    foot_[axis] = floor_;
    Vec3f half = box.size() * 0.5f;
    half[axis] *= 0.5f;
    shadow_reach_ = 1.6f * norm(half) + below;
    // From below or parallel to the ground, no shadow is visible.
    const bool above = camera_.parallel ? dot(camera_.backward, up_frame_.n) > 1e-3f
                                        : dot(camera_.position, up_frame_.n) > floor_ + 0.02f;
    ground_ = above && dot(key_frame_.n, up_frame_.n) > 0.1f;
  }

  void set_frame(const PictureFrame& frame) { frame_ = frame; }

  Image paint(Progress& progress) const {
    Image image(options_.view.width, options_.view.height);
    const int across = (options_.view.width + kTile - 1) / kTile, down = (options_.view.height + kTile - 1) / kTile;
    const auto tiles = static_cast<std::size_t>(across) * static_cast<std::size_t>(down);
    progress.begin("rendering", tiles);
    parallel_for(0, tiles, 1, [&](std::size_t tile) {
      paint_tile(static_cast<int>(tile) % across * kTile, static_cast<int>(tile) / across * kTile, image);
      progress.advance();
    });
    progress.finish();
    return image;
  }

 private:
  void paint_tile(int left, int top, Image& image) const {
    const int right = std::min(left + kTile, image.width), bottom = std::min(top + kTile, image.height);
    Batch batch(camera_);
    std::vector<Pixel> pixels;
    if (rim_ == 0) {  // without smoothing, each block is finished immediately
      constexpr int kStride = kBlock - 1;
      pixels.resize(static_cast<std::size_t>(kStride) * kStride);
      for (int v = top; v < bottom; v += kStride)
        for (int u = left; u < right; u += kStride) {
          const auto at = [&](int x, int y) -> Pixel& {
            return pixels[static_cast<std::size_t>((y - v) * kStride + x - u)];
          };
          look(u, v, std::min(u + kStride, right), std::min(v + kStride, bottom), batch, at);
          for (const auto& [x, y] : batch.pixels) image.at(x, y) = finish(at(x, y), x, y);
        }
      return;
    }
    constexpr int kStride = kTile + 2 * kSmooth;
    pixels.resize(static_cast<std::size_t>(kStride) * kStride);
    const auto at = [&](int x, int y) -> Pixel& {
      return pixels[static_cast<std::size_t>((y - top + kSmooth) * kStride + x - left + kSmooth)];
    };
    // A rim around the tile is needed for smoothing, also beyond the picture's border.
    for (int y = top - rim_; y < bottom + rim_; y += kBlock)
      for (int x = left - rim_; x < right + rim_; x += kBlock)
        look(x, y, std::min(x + kBlock, right + rim_), std::min(y + kBlock, bottom + rim_), batch, at);
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x) image.at(x, y) = finish(smoothed(at, x, y), x, y);
  }

  /// Computes all pixels of a block, with their rays in one batch.
  template <class At>
  void look(int left, int top, int right, int bottom, Batch& batch, const At& at) const {
    const int n = options_.quality.samples;
    batch.pixels.clear();
    for (int v = top; v < bottom; v += kCoherent)
      for (int u = left; u < right; u += kCoherent)
        for (int y = v; y < std::min(v + kCoherent, bottom); ++y)
          for (int x = u; x < std::min(u + kCoherent, right); ++x) batch.pixels.emplace_back(x, y);
    batch.eye.clear();
    for (const auto& [x, y] : batch.pixels)
      for (int s = 0; s < n * n; ++s) {
        const int column = s % n, row = s / n;
        const float fx = static_cast<float>(x) + (static_cast<float>(column) + 0.5f) / static_cast<float>(n);
        const float fy = static_cast<float>(y) + (static_cast<float>(row) + 0.5f) / static_cast<float>(n);
        batch.eye.add(2 * fx / static_cast<float>(options_.view.width) - 1,
                      1 - 2 * fy / static_cast<float>(options_.view.height));
      }
    const EyeRays eye = batch.eye.rays();
    batch.points.resize(eye.size());
    scene_.closest(eye, batch.points);
    if (options_.look.accessibility) find_access(batch);

    batch.rays.clear();
    const auto all_pixels = [&](auto& blocked) {
      std::size_t first = 0;
      for (const auto& [x, y] : batch.pixels) {
        at(x, y) = pixel(x, y, eye, first, &batch.points[first], blocked);
        if (options_.look.accessibility) at(x, y).access = batch.access[first / static_cast<std::size_t>(n * n)];
        first += static_cast<std::size_t>(n * n);
      }
    };
    Recorder recorder{batch.rays};
    all_pixels(recorder);
    if (batch.rays.empty()) return;
    batch.answers.resize(batch.rays.size());
    scene_.blocked(batch.rays, batch.answers);
    Replay replay{batch.answers.data()};
    all_pixels(replay);
  }

  /// Factors above 1 for convex and below 1 for concave curvature, at the first ray of each pixel that hits.
  void find_access(Batch& batch) const {
    batch.access.assign(batch.pixels.size(), 1);
    if (options_.look.curvature == nullptr || options_.look.curvature_shading == 0) return;
    const EyeRays eye = batch.eye.rays();
    const std::size_t each = batch.points.size() / batch.pixels.size();
    std::vector<Vec3> points;
    std::vector<Vec3f> normals;
    std::vector<std::size_t> whose;
    for (std::size_t p = 0; p < batch.pixels.size(); ++p) {
      std::size_t i = p * each;
      while (i < (p + 1) * each && !batch.points[i]) ++i;
      if (i == (p + 1) * each) continue;
      points.push_back(Vec3(eye.at(i, batch.points[i]->distance)) * frame_.size + frame_.center);
      normals.push_back(batch.points[i]->normal);
      whose.push_back(p);
    }
    std::vector<PrincipalCurvatures> curvatures(points.size());
    if (!points.empty()) options_.look.curvature->evaluate(points, normals, curvatures);
    const auto radius = static_cast<float>(*options_.look.accessibility * frame_.size);
    for (std::size_t k = 0; k < whose.size(); ++k)
      batch.access[whose[k]] =
          curvature_factor(mean_curvature(curvatures[k]) * radius, static_cast<float>(options_.look.curvature_shading));
  }

  template <class Blocked>
  Pixel pixel(int x, int y, const EyeRays& eye, std::size_t first, const std::optional<SurfacePoint>* points,
              Blocked& blocked) const {
    const int n = options_.quality.samples;
    const int part = pattern_part(x, y);
    Pixel sum;
    int on = 0;
    float cover = 0;
    const int asking = (n * n + 1) / 2;
    for (int s = 0; s < n * n; ++s) {
      if (points[s]) {
        add_surface(*points[s], eye.directions[first + static_cast<std::size_t>(s)], part * n * n + s, sum, blocked);
        ++on;
        cover += points[s]->cover;
      } else if (s % 2 == 0) {  // the shadow is smooth: half of the samples suffice
        const std::size_t ray = first + static_cast<std::size_t>(s);
        sum.dark += ground_shadow(eye.origin(ray), eye.directions[ray], part * asking + s / 2, blocked);
        sum.asked += 1;
      }
    }
    if (sum.asked > 0) sum.dark /= sum.asked;
    if (on == 0) return sum;
    const float share = 1 / static_cast<float>(on);
    for (Vec3f* v : {&sum.position, &sum.normal, &sum.color, &sum.ambient, &sum.beyond}) *v *= share;
    sum.lit = sum.lit_asked > 0 ? sum.lit / sum.lit_asked : 1;
    for (float* v : {&sum.open, &sum.facing, &sum.fill, &sum.shine, &sum.sheen}) *v *= share;
    sum.cover = cover / static_cast<float>(n * n);
    return sum;
  }

  /// Replaces shadows by means over neighbours on the same smooth piece of surface, to remove noise of few rays; shape
  /// and colour stay.
  template <class At>
  Pixel smoothed(const At& at, int x, int y) const {
    Pixel pixel = at(x, y);
    const float far = 3 * footprint_ * (camera_.parallel ? 1 : norm(pixel.position - camera_.position));
    float weights = 0, lit_weights = 0, ground = 0, open = 0, lit = 0, dark = 0;
    Vec3f ambient;
    for (int v = y - kSmooth; v <= y + kSmooth; ++v) {
      for (int u = x - kSmooth; u <= x + kSmooth; ++u) {
        const Pixel& other = at(u, v);
        ground += other.asked;
        dark += other.asked * other.dark;
        const float likeness = 5 * dot(pixel.normal, other.normal) - 4;
        if (likeness <= 0 || std::abs(dot(pixel.normal, other.position - pixel.position)) > far) continue;
        const float weight = likeness * other.cover;
        weights += weight;
        open += weight * other.open;
        lit_weights += likeness * other.lit_asked;
        lit += likeness * other.lit_asked * other.lit;
        ambient += weight * other.ambient;
      }
    }
    if (weights > 0) {
      pixel.open = open / weights;
      pixel.ambient = ambient / weights;
    }
    if (lit_weights > 0) pixel.lit = lit / lit_weights;
    if (ground > 0) pixel.dark = dark / ground;
    return pixel;
  }

  Rgba finish(const Pixel& pixel, int x, int y) const {
    if (options_.look.effective_background().kind == Background::Kind::transparent) return transparent_color(pixel);
    if (options_.look.effective_background().kind == Background::Kind::solid && pixel.cover == 0 && pixel.dark == 0)
      return paper_;
    const Rgba color = opaque_color(pixel, background(x, y));
    if (options_.look.effective_background().kind == Background::Kind::solid || pixel.cover > 0) return color;
    return dithered(color, x, y);
  }

  Vec3f background(int x, int y) const {
    return background_light(options_, (static_cast<float>(x) + 0.5f) / static_cast<float>(options_.view.width),
                            (static_cast<float>(y) + 0.5f) / static_cast<float>(options_.view.height));
  }

  template <class Blocked>
  bool in_key_shadow(const Vec3f& from, int index, Blocked& blocked) const {
    const Spot& spot = spots_[static_cast<std::size_t>(index)];
    return blocked(from, key_frame_({kLightSpread * spot.x, kLightSpread * spot.y}),
                   std::numeric_limits<float>::infinity());
  }

  template <class Blocked>
  void add_surface(const SurfacePoint& point, const Vec3f& direction, int index, Pixel& sum, Blocked& blocked) const {
    const Vec3f& n = point.normal;
    sum.position += point.position;
    sum.normal += n;
    sum.color += point.color;
    sum.beyond += point.beyond;
    add_ambient(point, index, sum, blocked);
    sum.fill += std::max(0.0f, dot(n, lighting_.fill));
    sum.sheen += point.gloss * lighting_.sheen(n, direction);
    const float facing = dot(n, lighting_.key);
    // Where the surface faces away, occlusion of the key light only matters to the neighbours.
    if (facing > 0) {
      sum.facing += facing;
      sum.shine += point.gloss * lighting_.shine(n, direction);
    }
    if (options_.quality.samples > 1 && index % 2 != 0) return;  // the shadow is smooth: half of the samples suffice
    if (!options_.look.shadows || options_.look.accessibility ||
        (facing > 0 && !in_key_shadow(point.position, index, blocked)))
      sum.lit += 1;
    sum.lit_asked += 1;
  }

  /// Ambient light on the surface, and its unoccluded share.
  template <class Blocked>
  void add_ambient(const SurfacePoint& point, int index, Pixel& sum, Blocked& blocked) const {
    const int rays = sky_rays_;
    if (rays == 0) {
      sum.ambient += lighting_.ambient(point.normal);
      sum.open += 1;
      return;
    }
    const Around frame(point.normal);
    const float share = 1 / static_cast<float>(rays);
    for (int k = 0; k < rays; ++k) {
      const Vec3f direction = frame(spots_[static_cast<std::size_t>(index * rays + k)]);
      const Vec3f light = lighting_.sky_light(direction) * share;
      if (blocked(point.position, direction, sky_reach_)) {
        sum.ambient += product(light, point.color) * kBounce;
      } else {
        sum.ambient += light;
        sum.open += share;
      }
    }
  }

  /// Darkening of the ground by the subject above it, 0..1.
  template <class Blocked>
  float ground_shadow(const Vec3f& origin, const Vec3f& direction, int index, Blocked& blocked) const {
    const Vec3f& up = up_frame_.n;
    const float descent = dot(direction, up);
    if (!ground_ || descent > -1e-3f) return 0;
    const Vec3f at = origin + (floor_ - dot(origin, up)) / descent * direction;
    const float d = norm(at - foot_) / shadow_reach_;
    if (d >= 1) return 0;
    float dark = in_key_shadow(at, index, blocked) ? 0.38f : 0.0f;
    if (options_.quality.occlusion_rays > 0) {
      const Spot& spot = spots_[static_cast<std::size_t>(index)];
      if (blocked(at, up_frame_(spot), kOcclusionReach)) dark += 0.5f;
    }
    return dark * (1 - d * d) * (1 - d * d);
  }

  const PictureScene& scene_;
  const Camera& camera_;
  const RenderOptions& options_;
  Lighting lighting_;
  Around up_frame_, key_frame_;
  int sky_rays_;  // per sample
  float sky_reach_;
  PictureFrame frame_;
  std::vector<Spot> spots_;
  Vec3f foot_;
  float footprint_ = 0;  // width of a pixel at distance 1, or of parallel rays at any distance
  int rim_ = kSmooth;    // pixels around a tile
  Rgba paper_;           // empty pixels on a solid background
  float floor_ = 0, shadow_reach_ = 1;
  bool ground_ = false;
};

Painter::Painter(const PictureScene& scene, const Camera& camera, const RenderOptions& options, bool smooth_light)
    : work_(std::make_unique<Work>(scene, camera, options, smooth_light)) {}
Painter::~Painter() = default;
void Painter::add_ground(std::span<const Vec3f> points, float below) { work_->add_ground(points, below); }
void Painter::set_frame(const PictureFrame& frame) { work_->set_frame(frame); }
Image Painter::paint(Progress& progress) const { return work_->paint(progress); }

}  // namespace sansmesh::inline v1
