#include "sansmesh/dataset/volume_surface.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/dataset/layer_fields.h"
#include "sansmesh/dataset/volume_layer.h"
#include "sansmesh/error.h"
#include "sansmesh/points/sampling/poisson_discs.h"
#include "sansmesh/search/ball_tree.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/surface/layer_projection.h"
#include "sansmesh/triangulation/divide_blocks.h"
#include "sansmesh/volume/samples/sample_slopes.h"

namespace sansmesh::inline v1 {
namespace {

/// h over the spacing without noise; its growth with the displacement of an isosurface by noise, in spacings; and its
/// upper bound.
constexpr double kWidth = 2, kWiden = 4, kMostWidth = 4;
/// Edge of blocks over the spacing, and radius of the balls filled with fine blocks over those of the domain.
constexpr double kBlockEdge = 2.1, kBlockReach = 0.6;
constexpr int kDeepestBlocks = 13;
constexpr double kAround = 4;  // margin of the cube of blocks beyond the layer, in spacings
/// Radius of the domain's balls over the spacing.
constexpr double kReach = 1.25;
/// Distance between feet() in spacings.
constexpr double kSplats = 0.75;

/// Values and options relative to the range of the values: squares and quotients of very large or small numbers would
/// overflow or underflow.
struct RelativeValues {
  double range;
  std::vector<double> values;
  VolumeSurfaceOptions options;
};

RelativeValues relative_values(std::span<const double> values, const VolumeSurfaceOptions& options) {
  const bool iso = options.kind == VolumeSurfaceOptions::Kind::isovalue;
  const auto [lowest, highest] = std::minmax_element(values.begin(), values.end());
  const double least = *lowest, range = *highest - least;
  if (!(range > 0)) throw DataError(fmt::format("is {:.6g} everywhere: there is no surface", least));
  if (iso && (options.value < least || options.value > *highest))
    throw DataError(fmt::format("does not have the value {:.6g}: values lie between {:.6g} and {:.6g}", options.value,
                                least, *highest));
  RelativeValues relative{range, std::vector<double>(values.size()), options};
  parallel_for(0, values.size(), 65536, [&](std::size_t i) { relative.values[i] = (values[i] - least) / range; });
  VolumeSurfaceOptions& o = relative.options;
  if (iso) o.value = (options.value - least) / range;
  if (iso && o.beta) o.beta = *o.beta / range;
  if (o.least_gradient) o.least_gradient = *o.least_gradient / range;
  return relative;
}

/// Input of the projection, in spatial order.
LayerSamples layer_of(const std::vector<WeightedSample>& chosen, const SampledVolume& samples,
                      const SampleSlopes& slopes, const LocalFrame& frame) {
  std::vector<Vec3f> positions(chosen.size());
  for (std::size_t i = 0; i < chosen.size(); ++i)
    positions[i] = Vec3f(frame.from_input(samples.position(chosen[i].sample)));
  const KdTree tree(positions);
  LayerSamples layer;
  for (std::vector<Vec3f>* v : {&layer.positions, &layer.normals}) v->reserve(chosen.size());
  for (std::vector<float>* v : {&layer.weights, &layer.spacing, &layer.reach}) v->reserve(chosen.size());
  double heaviest = 0;
  for (const WeightedSample& c : chosen) heaviest = std::max(heaviest, c.weight);
  for (const std::uint32_t i : tree.order()) {
    const WeightedSample& c = chosen[i];
    const auto s = static_cast<float>(frame.from_input(slopes.spacing(c.sample)));
    layer.positions.push_back(positions[i]);
    layer.normals.push_back(Vec3f(normalized(c.gradient * -1.0)));
    layer.weights.push_back(static_cast<float>(c.weight / heaviest));
    layer.spacing.push_back(s);
    layer.reach.push_back(c.ball ? s * static_cast<float>(kReach) : 0);
  }
  return layer;
}

/// Share of smoothed values where noise moves isosurfaces by this many spacings.
double smoothed_share(double moved) {
  constexpr double kNone = 0.25, kAll = (kMostWidth - kWidth) / kWiden;
  return std::clamp((moved - kNone) / (kAll - kNone), 0.0, 1.0);
}

std::vector<double> between(std::span<const double> values, std::vector<double> smoothed, double share) {
  for (std::size_t i = 0; i < values.size(); ++i) smoothed[i] = values[i] + share * (smoothed[i] - values[i]);
  return smoothed;
}

}  // namespace

struct VolumeSurface::State {
  std::shared_ptr<const SampledVolume> volume;
  LocalFrame frame;
  VolumeSurfaceOptions options;
  VolumeSurfaceReport report;
  std::optional<LayerProjection> projection;
  SurfaceFeet feet;                         ///< feet of `sample_balls`
  std::unique_ptr<const ScalarField> side;  ///< sides of points outside the balls
  BallUnion sample_balls;                   ///< samples next to the surface, with a ball around each
  std::vector<float> sample_spacing;        ///< spacing at `sample_balls`
  std::unique_ptr<const VolumeDomain> domain;
  std::unique_ptr<const ScalarField> field;
  BallUnion balls;
  std::vector<float> spacing;
};

VolumeSurface make_volume_surface(std::shared_ptr<const SampledVolume> volume, std::span<const double> values,
                                  double noise, const VolumeSurfaceOptions& options, Progress& progress,
                                  const std::function<std::optional<std::vector<double>>()>& smoothed) {
  options.validate();
  auto state = std::make_unique<VolumeSurface::State>();
  VolumeSurfaceReport& r = state->report;
  const Box3 box = volume->bounds();
  const LocalFrame frame = frame_for(box.center(), box.diagonal());
  state->frame = frame, state->options = options;
  r.noise = noise;

  const bool iso = options.kind == VolumeSurfaceOptions::Kind::isovalue;
  const SampledVolume& samples = *volume;
  if (samples.size() != values.size()) throw ArgumentError("the numbers of values and samples differ");
  if (samples.size() > std::numeric_limits<std::uint32_t>::max()) throw DataError("has more than 2³² samples");
  const RelativeValues relative = relative_values(values, options);
  progress.begin("slopes");
  const SampleSlopes slopes(samples, relative.values);
  const double range = relative.range;
  const std::vector<WeightedSample> chosen =
      iso ? isovalue_layer(slopes, relative.values, noise / range, relative.options, r, progress)
          : high_gradient_layer(samples, slopes, noise / range, relative.options, r, progress);
  if (const double share = smoothed ? smoothed_share(r.noise_distance / samples.facts.median_spacing) : 0; share > 0)
    if (std::optional<std::vector<double>> smooth = smoothed()) {
      VolumeSurface surface =
          make_volume_surface(volume, between(values, std::move(*smooth), share), noise, options, progress);
      surface.state_->report.smoothed = share;
      return surface;
    }
  r.slope *= range, r.least_gradient *= range, r.beta = iso ? options.beta : r.beta;
  if (std::none_of(chosen.begin(), chosen.end(), [](const WeightedSample& c) { return c.ball; }))
    throw DataError(iso ? fmt::format("has no sample near enough to the value {:.6g}", options.value)
                        : fmt::format("has no border where the gradient is {:.6g} or more", r.least_gradient));
  progress.begin("prepare projection");
  const LayerSamples layer = layer_of(chosen, samples, slopes, frame);
  for (std::size_t i = 0; i < layer.reach.size(); ++i)
    if (layer.reach[i] > 0) state->sample_spacing.push_back(layer.spacing[i]);
  r.samples = chosen.size();
  std::vector<float> sorted = state->sample_spacing;
  r.spacing = frame.to_input(static_cast<double>(median(sorted)));
  const double moved = r.spacing > 0 ? r.noise_distance / r.spacing : 0;
  r.smoothing = options.smoothing.value_or(std::min(kWidth + kWiden * moved, kMostWidth));

  LayerOptions projection;
  projection.smoothing = r.smoothing;
  projection.predictor = options.predictor, projection.corrector = options.corrector;
  projection.alternating = options.alternating, projection.line_search = options.line_search;
  projection.separate_sheets = options.separate_sheets;
  state->projection.emplace(layer, projection);
  state->sample_balls = state->projection->balls();
  progress.begin("project");
  state->feet = find_feet(*state->projection, state->sample_balls.centers, state->sample_spacing);
  const SurfaceFeet& feet = state->feet;
  progress.check();
  if (feet.feet.empty()) throw DataError("has no such surface");
  const Box3 bounds = state->projection->bounds();
  state->side =
      iso ? value_side(samples, relative.values, relative.options.value, frame, bounds) : plane_side(feet, bounds);
  progress.begin("boundary");
  state->domain = std::make_unique<const VolumeDomain>(samples, frame);
  std::unique_ptr<const ScalarField> field;
  if (options.exact_projection) {
    field = std::make_unique<const ProjectionField>(*state->projection, state->side.get());
    state->balls = state->sample_balls, state->spacing = state->sample_spacing;
  } else {
    auto of_feet = std::make_unique<const FootField>(feet, state->side.get());
    state->balls = of_feet->balls(), state->spacing = feet.spacing;
    field = std::move(of_feet);
  }
  state->field = cut_at_volume(std::move(field), *state->domain, state->balls);
  state->volume = std::move(volume);
  progress.finish();
  return VolumeSurface(std::move(state));
}

VolumeSurface::VolumeSurface(std::unique_ptr<State> state) : state_(std::move(state)) {}
VolumeSurface::~VolumeSurface() = default;
VolumeSurface::VolumeSurface(VolumeSurface&&) noexcept = default;
VolumeSurface& VolumeSurface::operator=(VolumeSurface&&) noexcept = default;

const SampledVolume& VolumeSurface::volume() const { return *state_->volume; }
const LocalFrame& VolumeSurface::frame() const { return state_->frame; }
const Projection& VolumeSurface::projection() const { return *state_->projection; }
const ScalarField& VolumeSurface::field() const { return *state_->field; }
const BallUnion& VolumeSurface::balls() const { return state_->balls; }
std::span<const float> VolumeSurface::spacing() const { return state_->spacing; }
const BallUnion& VolumeSurface::sample_balls() const { return state_->sample_balls; }
std::span<const float> VolumeSurface::sample_spacing() const { return state_->sample_spacing; }
const VolumeDomain& VolumeSurface::domain() const { return *state_->domain; }
PointSet VolumeSurface::feet() const {
  std::vector<Vec3> positions;
  positions.reserve(state_->feet.feet.size());
  for (const FootPoint& foot : state_->feet.feet) positions.push_back(foot.position);
  const auto kept = poisson_discs(positions, kSplats * state_->frame.from_input(state_->report.spacing));
  PointSet points;
  points.positions.reserve(kept.size()), points.normals.reserve(kept.size());
  for (const std::uint32_t i : kept) {
    points.positions.push_back(Vec3f(positions[i]));
    points.normals.push_back(Vec3f(state_->feet.feet[i].normal));
  }
  return points;
}
const VolumeSurfaceOptions& VolumeSurface::options() const { return state_->options; }
const VolumeSurfaceReport& VolumeSurface::report() const { return state_->report; }

BlockTree VolumeSurface::blocks() const {
  const BallUnion& balls = state_->balls;
  std::vector<float> radii = balls.radii;
  for (float& r : radii) r *= static_cast<float>(kBlockReach);
  const BallTree near(balls.centers, radii);
  const Vec3 size = state_->projection->bounds().size();
  // The surface must not reach the cube's faces, where it would be closed.
  const double edge =
      std::max({size.x, size.y, size.z}) + 2 * kAround * state_->frame.from_input(state_->report.spacing);
  BlockTree tree(state_->projection->bounds().center() - Vec3{edge, edge, edge} * 0.5, edge);
  divide_blocks(tree, kDeepestBlocks, [&](std::size_t block, std::vector<std::uint32_t>& touched) {
    const double half = tree.block_edge(block) / 2;
    const Vec3 center = tree.block_center(block), h{half, half, half};
    near.touching({Vec3f(center - h), Vec3f(center + h)}, touched);
    float least = std::numeric_limits<float>::infinity();
    for (const std::uint32_t t : touched) least = std::min(least, state_->spacing[t]);
    return !touched.empty() && 2 * half > kBlockEdge * static_cast<double>(least);
  });
  return tree;
}

}  // namespace sansmesh::inline v1
