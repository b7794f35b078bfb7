#include "sansmesh/render/splat/blended_splats.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "sansmesh/box.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/data/world_points.h"
#include "sansmesh/error.h"
#include "sansmesh/render/scene/lighting.h"
#include "sansmesh/render/scene/painter.h"
#include "sansmesh/render/scene/sample_pattern.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

/// Number of neighbours on the same sheet that determine the spacing, and number of candidates.
constexpr std::size_t kAround = 6, kAsked = 16;
/// Area per point, relative to the mean squared distance of these neighbours: 0.87 for a hexagonal lattice, 0.6 for
/// discs at random positions.
constexpr float kAreaOfSquare = 0.75f;
/// Standard deviation relative to the root of that area: weights of an even sheet then sum to 1 within a percent.
constexpr float kWidthOfSplat = 0.8f;
/// Largest width of a splat relative to the median of its neighbours, so that borders keep their position.
constexpr float kWidestSplat = 1.25f;
constexpr float kLongestSplat = 2;
/// Relative to the standard deviation: radius of shadow-casting discs, and height of ray origins above them.
constexpr float kDiscOfSplat = 1.5f, kLiftOfSplat = 1.2f;

/// Number of rays that test whether splats bound a body, and the share of them that may escape.
constexpr std::size_t kInwardRays = 4000;
constexpr double kMayLeave = 0.005;

/// Mean squared distance of each point to its neighbours; 0 if there are none.
std::vector<float> squared_spacings(const EllipticSplats& splats) {
  const KdTree tree(splats.centers);
  std::vector<float> squares(splats.centers.size());
  std::vector<std::array<std::uint32_t, kAround>> around(squares.size());
  std::vector<std::uint8_t> known(squares.size());
  parallel_for(0, squares.size(), 1024, [&](std::size_t i) {
    std::array<Neighbour, kAsked> near;
    const std::size_t n = tree.nearest(splats.centers[i], near);
    float sum = 0;
    for (std::size_t k = 0; k < n && known[i] < kAround; ++k) {
      if (near[k].index == i || dot(splats.normals[near[k].index], splats.normals[i]) <= 0) continue;
      sum += near[k].squared_distance;
      around[i][known[i]++] = near[k].index;
    }
    if (known[i] > 0) squares[i] = sum / static_cast<float>(known[i]);
  });
  std::vector<float> limited(squares.size());
  parallel_for(0, squares.size(), 1024, [&](std::size_t i) {
    std::array<float, kAround> others;
    for (std::size_t k = 0; k < known[i]; ++k) others[k] = squares[around[i][k]];
    limited[i] = std::min(squares[i], kWidestSplat * kWidestSplat * median(std::span(others).first(known[i])));
  });
  return limited;
}

/// Whether rays that start inwards from all over the surface meet it again.
bool bounds_a_body(const EllipticSplats& splats, const RayScene& discs) {
  const std::size_t n = splats.centers.size(), rays = std::min(n, kInwardRays);
  const std::vector<Spot> spots = spread_over_disc(static_cast<int>(rays));
  std::vector<std::uint8_t> leaves(rays);
  parallel_for(0, rays, 64, [&](std::size_t k) {
    const std::size_t i = k * n / rays;
    const Vec3f inward = -splats.normals[i];
    leaves[k] = !discs.blocked(splats.centers[i] + inward * (kLiftOfSplat * norm(splats.minor[i])),
                               Around(inward)(spots[k]), std::numeric_limits<float>::infinity());
  });
  const auto left = std::count(leaves.begin(), leaves.end(), std::uint8_t{1});
  return static_cast<double>(left) <= kMayLeave * static_cast<double>(rays);
}

}  // namespace

EllipticSplats splats_at_points(const PointSet& points, std::span<const SplatStretch> stretches,
                                const RenderOptions& options, const PictureFrame& frame) {
  if (!stretches.empty() && stretches.size() != points.size())
    throw ArgumentError("splats_at_points: as many stretches as points are needed");
  if (!points.has_normals()) throw DataError("splats need normals");
  const bool colored = options.look.use_colors && points.has_colors();
  EllipticSplats splats;
  std::vector<std::uint32_t> rows;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3f normal = normalized(points.normals[i]);
    if (!is_finite(points.positions[i]) || !is_finite(normal) || !(squared_norm(normal) > 0)) continue;
    rows.push_back(static_cast<std::uint32_t>(i));
    splats.centers.push_back(frame.to_picture(points.origin + Vec3(points.positions[i])));
    splats.normals.push_back(normal);
    Vec3f color = options.look.surface_color;
    if (colored)
      color = {from_byte(points.colors[i][0]), from_byte(points.colors[i][1]), from_byte(points.colors[i][2])};
    splats.colors.push_back(linear_color(color));
  }
  if (rows.empty()) throw DataError("nothing to draw: no finite points with normals");
  const std::vector<float> squares = squared_spacings(splats);
  splats.areas.resize(rows.size());
  splats.major.resize(rows.size());
  splats.minor.resize(rows.size());
  parallel_for(0, rows.size(), 4096, [&](std::size_t i) {
    const Vec3f& n = splats.normals[i];
    Vec3f along, across;
    tangent_frame(n, along, across);
    float ratio = 1;
    if (!stretches.empty()) {
      const SplatStretch& stretch = stretches[rows[i]];
      const Vec3f flat = stretch.direction - n * dot(n, stretch.direction);
      if (squared_norm(flat) > 0) {
        along = normalized(flat), across = cross(n, along);
        ratio = std::clamp(stretch.ratio, 1.0f, kLongestSplat);
      }
    }
    splats.areas[i] = kAreaOfSquare * squares[i];
    const float width = kWidthOfSplat * std::sqrt(splats.areas[i]);
    splats.major[i] = along * (width * ratio);
    splats.minor[i] = across * width;
  });
  return splats;
}

BlendedScene::BlendedScene(const SplatLayers& layers, const RayScene& discs, const Camera& camera,
                           const RenderOptions& options)
    : layers_(layers), discs_(discs), camera_(camera), options_(options) {}

void BlendedScene::closest(const EyeRays& rays, std::span<std::optional<SurfacePoint>> points) const {
  const auto width = static_cast<float>(options_.view.width), height = static_cast<float>(options_.view.height);
  const auto n = static_cast<float>(options_.quality.samples);
  const float part = 1 / (n * n);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    points[i].reset();
    const ProjectedPoint projected =
        camera_.project(rays.origin(i) + (camera_.parallel ? 0.0f : 1.0f) * rays.directions[i]);
    const float x = (projected.x + 1) * 0.5f * width, y = (1 - projected.y) * 0.5f * height;
    const float left = std::floor(x), top = std::floor(y);
    const std::span<const SplatLayer> layers = layers_.at(whole_part<int>(left), whole_part<int>(top));
    if (layers.empty()) continue;
    // Each ray of the pixel represents a part of its cover, and takes the layer with most of that part.
    const float first = part * (std::floor((y - top) * n) * n + std::floor((x - left) * n)), last = first + part;
    const SplatLayer* most = nullptr;
    float begin = 0, largest = 0, covered = 0;
    for (const SplatLayer& layer : layers) {
      const float common = std::min(last, begin + layer.share) - std::max(first, begin);
      begin += layer.share;
      if (!(common > 0)) continue;
      covered += common;
      if (common > largest) largest = common, most = &layer;
    }
    if (most == nullptr) continue;
    const Vec3f at = rays.at(i, most->distance);
    SurfacePoint point{most->distance, at + most->normal * (kLiftOfSplat * most->width), most->normal, most->color};
    point.cover = std::min(1.0f, covered / part);
    if (point.cover > 1 - 1e-3f) point.cover = 1;
    points[i] = point;
  }
}

void BlendedScene::blocked(std::span<const ShadowRay> rays, std::span<std::uint8_t> answers) const {
  for (std::size_t i = 0; i < rays.size(); ++i)
    answers[i] = discs_.blocked(rays[i].origin, rays[i].direction, rays[i].length, rays[i].near);
}

struct SplatPicture::State {
  PictureFrame frame;
  EllipticSplats splats;
  RayScene discs;
};

SplatPicture::SplatPicture(const PointSet& points, std::span<const SplatStretch> stretches,
                           const RenderOptions& options) {
  const PictureFrame frame = frame_of_points(finite_bounds(points.origin, points.positions));
  EllipticSplats splats = splats_at_points(points, stretches, options, frame);
  std::vector<float> radii;
  radii.reserve(splats.centers.size());
  for (const Vec3f& b : splats.minor) radii.push_back(std::max(1e-6f, kDiscOfSplat * norm(b)));
  RayScene discs = RayScene::discs(splats.centers, splats.normals, radii);
  splats.closed = bounds_a_body(splats, discs);
  state_ = std::make_unique<State>(State{frame, std::move(splats), std::move(discs)});
}

SplatPicture::~SplatPicture() = default;
std::size_t SplatPicture::size() const { return state_->splats.centers.size(); }

Image SplatPicture::render(const RenderOptions& options, Progress& progress) const {
  options.validate();
  const State& s = *state_;
  const Camera camera = picture_camera(s.splats.centers, s.frame, options);
  progress.begin("splats");
  SplatRasterOptions how;
  how.width = options.view.width, how.height = options.view.height, how.rim = kSmooth;
  if (options.view.clip_box)
    how.clip =
        Box3f{s.frame.to_picture(options.view.clip_box->lower), s.frame.to_picture(options.view.clip_box->upper)};
  const SplatLayers layers(s.splats, camera, how);
  const BlendedScene scene(layers, s.discs, camera, options);
  return paint_scene(scene, camera, s.frame, options, true, s.splats.centers, 0, progress);
}

}  // namespace sansmesh::inline v1
