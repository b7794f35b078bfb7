#include "sansmesh/model/surface_model.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <utility>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/mpu/mpu_surface.h"
#include "sansmesh/partition/partition_fit.h"
#include "sansmesh/points/denoise_normals.h"
#include "sansmesh/points/sample_colors.h"
#include "sansmesh/search/ball_tree.h"
#include "sansmesh/surface/bilateral_normals.h"

namespace sansmesh {
namespace {

/// Balls that must hold fine blocks: this share of the radius within which the surface is defined.
constexpr double kBlockReach = 0.4;
/// Edge of a block over the spacing of the samples near it, for coarseness 1; over the width of the weights where these
/// are wider: a surface has no finer features.
constexpr double kBlockEdge = 1.4, kThinBlockEdge = 1.2;
constexpr int kDeepest = 13;
/// Of what closes holes, where nothing tells how the surface bends: the radius of a ball over what stands for the
/// spacing.
constexpr float kGapBlocks = 2;
/// Newton steps from a sample to the surface.
constexpr int kFootSteps = 2;
/// Around a block whose flatness is asked for it has to reach so far beyond, in edges.
constexpr double kFlatMargin = 0.25;
/// Least cosine of the normals around a flat block to their mean: of one sheet, and no fold.
constexpr double kAlike = 0.87;
/// Cosine of normals on the two sides of a wall, below.
constexpr float kOpposite = -0.85f;
/// A surface of curvature κ around a block of edge e leaves triangles of that edge a gap of κe²/8 in their middle, and
/// rises by κR²/2 within R = 1.1 e, block and margin: 4.8 times that. On average it is two thirds of that gap, and half
/// of this where triangles straddle the surface.
constexpr double kHeightOverGap = 14;
/// Flat blocks are no larger than so many times the finest there: what lies between samples should be looked at.
constexpr double kLargest = 16;

/// The supports that the surface passes through.
BallUnion support_balls(const PartitionOfUnity& partition) {
  BallUnion balls;
  std::vector<Vec3> centers;
  for (const LocalFunction& f : partition.functions()) centers.emplace_back(f.center);
  std::vector<double> values(centers.size());
  partition.evaluate(centers, values);
  for (std::size_t i = 0; i < centers.size(); ++i) {
    const LocalFunction& f = partition.functions()[i];
    if (std::abs(values[i]) > 1.2 * static_cast<double>(f.radius)) continue;
    balls.centers.push_back(f.center);
    balls.radii.push_back(f.radius);
  }
  return balls;
}

/// Of fields whose patches do not meet, and of others (`jump`).
constexpr double kJumpOfPatches = 0.5, kJumpOfOthers = 0.01;

/// Whether large triangles would do.
struct Flatness {
  const PointSet& feet;  ///< of the balls' centres
  double most;           ///< accepted gap between surface and triangles, on average (length)

  /// Whether these are samples of both sides of a wall: whether any look away from the one that looks away most from
  /// the first, which may lie on the rim.
  bool two_sided(std::span<const std::uint32_t> samples) const {
    const auto cosine = [&](std::uint32_t i, std::uint32_t j) { return dot(feet.normals[i], feet.normals[j]); };
    const std::uint32_t first = samples.front();
    const std::uint32_t side = *std::min_element(samples.begin(), samples.end(), [&](std::uint32_t i, std::uint32_t j) {
      return cosine(i, first) < cosine(j, first);
    });
    return std::any_of(samples.begin(), samples.end(), [&](std::uint32_t i) { return cosine(i, side) < kOpposite; });
  }

  /// Whether triangles of a block with this edge length would do for what these samples stand for.
  bool holds(std::span<const std::uint32_t> samples) const {
    Vec3 normal, middle;
    for (const std::uint32_t i : samples) normal += Vec3(feet.normals[i]), middle += Vec3(feet.positions[i]);
    normal = normalized(normal);
    middle = middle / static_cast<double>(samples.size());
    double least = 0, largest = 0;
    for (const std::uint32_t i : samples) {
      if (dot(Vec3(feet.normals[i]), normal) < kAlike) return false;
      const double height = dot(Vec3(feet.positions[i]) - middle, normal);
      least = std::min(least, height), largest = std::max(largest, height);
      if (largest - least > kHeightOverGap * most) return false;
    }
    return true;
  }
};

}  // namespace

namespace {

/// Iterated normals, from which the sharp ones start.
class SharpenedNormals : public NormalField {
 public:
  SharpenedNormals(const NormalField& first, const NormalField& then) : first_(first), then_(then) {}
  void refine(std::span<const Vec3> x, std::span<Vec3> normals) const override {
    first_.refine(x, normals);
    then_.refine(x, normals);
  }

 private:
  const NormalField &first_, &then_;
};

}  // namespace

struct SurfaceModel::State {
  PreparedCloud cloud;
  SurfaceReport report;
  std::optional<PartitionOfUnity> partition;
  std::optional<ImplicitSurface> implicit;
  std::optional<ProjectionSurface> projection;
  std::optional<ProjectionField> projection_field;
  std::optional<MpuSurface> mpu;
  const ScalarField* field = nullptr;  // of a projection: made when it is first asked for, which pictures never do
  std::once_flag field_made;
  std::optional<BilateralNormals> normals;
  std::optional<IteratedNormals> iterated;
  std::unique_ptr<NormalField> sharpened;  // null unless both
  std::optional<FaceField> placement;
  std::optional<SampleColors> colors;
  BallUnion balls;
  std::vector<float> spacing;  // of the samples at the balls' centres; empty for the partition

  void make_field(Progress& progress);
  void use_partition();
  void use_mpu(const SurfaceSamples& samples, const SurfaceOptions& options, Progress& progress);
  BlockTree blocks(double coarseness, const std::optional<Flatness>& flat) const;
  Box3 bounds() const { return projection ? projection->bounds() : field->bounds(); }
};

/// What only polygonisers need: for a projection, a field that also knows on which side points are that are too far
/// away to be projected; and where to put the vertices of sharp meshes.
void SurfaceModel::State::make_field(Progress& progress) {
  if (projection) {
    progress.begin("sides of the surface");
    progress.check();
    ImplicitOptions beyond;
    beyond.method = ImplicitMethod::kolluri;
    implicit = make_implicit_surface(projection->samples(), beyond, progress);
    projection_field.emplace(*projection, &*implicit);
    field = &*projection_field;
    progress.finish();
  }
  if (normals) placement.emplace(*field, *normals);
}

void SurfaceModel::State::use_partition() {
  field = &*partition;
  balls = support_balls(*partition);
  report.spacing = cloud.place.to_input(partition->report().spacing);
  report.noise = cloud.place.to_input(partition->report().noise);
}

namespace {

ImplicitOptions implicit_options(const SurfaceOptions& options, const std::optional<double>& bandwidth) {
  ImplicitOptions o;
  o.method = std::get<ImplicitMethod>(surface_method_info(options.method).formula);
  o.smoothing = options.smoothing, o.bandwidth = bandwidth, o.weights = options.weights;
  o.order = options.order, o.iterations = options.iterations, o.epsilon = options.epsilon;
  o.normal = options.normal;
  o.separate_sheets = options.separate_sheets;
  return o;
}

ProjectionOptions projection_options(const SurfaceOptions& options, const std::optional<double>& bandwidth) {
  ProjectionOptions o;
  o.method = std::get<ProjectionMethod>(surface_method_info(options.method).formula);
  o.smoothing = options.smoothing, o.bandwidth = bandwidth, o.weights = options.weights;
  o.plane = options.plane, o.polynomial = options.polynomial;
  o.flow = options.flow, o.diffusion = options.diffusion;
  o.threshold = options.threshold.value_or(o.threshold), o.tau = options.tau.value_or(o.tau);
  o.separate_sheets = options.separate_sheets;
  return o;
}

/// Without what follows from the data. Lengths are in the unit of the input.
MpuOptions mpu_options(const SurfaceOptions& options) {
  MpuOptions o;
  o.error = options.error, o.max_depth = options.max_depth, o.sharp = !options.smooth;
  return o;
}

}  // namespace

/// Balls around the samples, as of the other surfaces, and those of cells without enough of them: what closes holes.
void SurfaceModel::State::use_mpu(const SurfaceSamples& samples, const SurfaceOptions& options, Progress& progress) {
  PointSet points;
  points.positions = samples.positions, points.normals = samples.normals;
  MpuOptions o = mpu_options(options);
  if (o.error) o.error = cloud.place.from_input(*o.error);
  o.spacing = samples.median_spacing;
  mpu = make_mpu_surface(points, o, progress);
  field = &*mpu;
  balls.centers = samples.positions, spacing = samples.spacing;
  const auto reach = static_cast<float>(default_reach(samples));
  for (const float s : spacing) balls.radii.push_back(reach * s);
  const BallUnion gaps = mpu->gap_balls({samples.tree, balls.radii});
  for (std::size_t i = 0; i < gaps.centers.size(); ++i) {
    const auto near = samples.tree.nearest(gaps.centers[i]);
    if (!near) continue;
    balls.centers.push_back(gaps.centers[i]), balls.radii.push_back(gaps.radii[i]);
    spacing.push_back(std::max(gaps.radii[i] / kGapBlocks, samples.spacing[near->index]));
  }
}

bool SurfaceOptions::is_set(SurfaceOption option) const {
  switch (option) {
    case SurfaceOption::smoothing:
      return smoothing.has_value();
    case SurfaceOption::bandwidth:
      return bandwidth.has_value();
    case SurfaceOption::order:
      return order.has_value();
    case SurfaceOption::iterations:
      return iterations.has_value();
    case SurfaceOption::weights:
      return weights != SurfaceWeights::compact;
    case SurfaceOption::epsilon:
      return epsilon.has_value();
    case SurfaceOption::normal:
      return normal != Normal::standard;
    case SurfaceOption::plane:
      return plane != Plane::iterated;
    case SurfaceOption::polynomial:
      return polynomial != Polynomial::quadratic;
    case SurfaceOption::flow:
      return flow != Flow::fit;
    case SurfaceOption::threshold:
      return threshold.has_value();
    case SurfaceOption::tau:
      return tau.has_value();
    case SurfaceOption::diffusion:
      return diffusion != Diffusion::none;
    case SurfaceOption::separate_sheets:
      return !separate_sheets;
    case SurfaceOption::sharp:
      return sharp;
    case SurfaceOption::error:
      return error.has_value();
    case SurfaceOption::max_depth:
      return max_depth.has_value();
    case SurfaceOption::smooth:
      return smooth;
  }
  throw ArgumentError("surfaces have no such option");
}

void SurfaceOptions::validate() const {
  const SurfaceMethodInfo& info = surface_method_info(method);
  for (std::size_t i = 0; i < kSurfaceOptions; ++i) {
    const auto option = static_cast<SurfaceOption>(i);
    if (!is_set(option) || info.heeds(option)) continue;
    const char* const field = field_name(option);
    throw ArgumentError(
        *info.instead ? fmt::format("`{}` means nothing to the surface {}: {}", field, info.name, info.instead)
                      : fmt::format("`{}` belongs to {}, not to the surface {}", field, heeded_by(option), info.name));
  }
  if (threshold && diffusion == Diffusion::none) throw ArgumentError("`threshold` needs `diffusion` = soft or hard");
  if (sharp_formula != SharpFormula::bilateral && !sharp) throw ArgumentError("`sharp_formula` needs `sharp`");
  if (info.family() == SurfaceFamily::implicit)
    implicit_options(*this, bandwidth).validate();
  else if (info.family() == SurfaceFamily::projection)
    projection_options(*this, bandwidth).validate();
  else if (info.family() == SurfaceFamily::mpu)
    mpu_options(*this).validate();
}

SurfaceModel make_surface_model(PointSet points, const SurfaceOptions& options, Progress& progress) {
  options.validate();
  return make_surface_model(prepare_cloud(std::move(points), {}, progress), options, progress);
}

SurfaceModel make_surface_model(PreparedCloud prepared, const SurfaceOptions& options, Progress& progress) {
  options.validate();
  auto state = std::make_unique<SurfaceModel::State>();
  state->cloud = std::move(prepared);
  PointSet& cloud = state->cloud.points;
  const Placement place = state->cloud.place;
  SurfaceReport& report = state->report;
  report.method = options.method;
  report.samples = cloud.size();
  // Estimates blur edges; normals that came with the samples may be exact, and are only worse for it.
  const bool mpu = options.method == SurfaceMethod::mpu;
  if ((options.sharp || (mpu && !options.smooth)) && state->cloud.estimated_normals) {
    progress.begin("denoise normals");
    denoise_normals(cloud, {.spacing = state->cloud.spacing, .noise = state->cloud.noise}, progress);
  }
  const auto bandwidth = options.bandwidth ? std::optional<double>(place.from_input(*options.bandwidth)) : std::nullopt;

  const SurfaceSamples* samples = nullptr;
  SurfaceSamples of_mpu;
  const SurfaceMethodInfo& info = surface_method_info(options.method);
  switch (info.family()) {
    case SurfaceFamily::partition:
      state->partition = fit_partition_of_unity(cloud, {}, progress);
      state->use_partition();
      break;
    case SurfaceFamily::implicit: {
      const ImplicitOptions o = implicit_options(options, bandwidth);
      state->implicit = make_implicit_surface(prepare_samples(cloud, progress, state->cloud.noise), o, progress);
      state->field = &*state->implicit;
      state->balls = state->implicit->balls();
      samples = &state->implicit->samples();
      report.smoothing = state->implicit->report().smoothing;
      report.order = state->implicit->report().order;
      report.iterations = state->implicit->report().iterations;
      break;
    }
    case SurfaceFamily::projection: {
      const ProjectionOptions o = projection_options(options, bandwidth);
      state->projection = make_projection_surface(prepare_samples(cloud, progress, state->cloud.noise), o, progress);
      state->balls = state->projection->balls();
      samples = &state->projection->samples();
      report.smoothing = state->projection->smoothing();
      break;
    }
    case SurfaceFamily::mpu:
      of_mpu = prepare_samples(cloud, progress, state->cloud.noise);
      state->use_mpu(of_mpu, options, progress);
      samples = &of_mpu;
      break;
  }
  if (samples) {
    if (!mpu) state->spacing = samples->spacing;
    report.spacing = place.to_input(samples->median_spacing);
    report.noise = place.to_input(samples->noise);
    if (options.sharp) {
      BilateralOptions o;
      o.formula = options.sharp_formula, o.weights = options.weights;
      if (o.formula == SurfaceOptions::SharpFormula::laguerre) {  // whose h and ε are those of the surface
        o.epsilon = options.epsilon.value_or(o.epsilon);
        o.smoothing = options.smoothing, o.bandwidth = bandwidth;
      }
      state->normals.emplace(*samples, o);
    }
    if (options.normal == SurfaceOptions::Normal::iterated) state->iterated.emplace(*state->implicit);
    if (state->iterated && state->normals)
      state->sharpened = std::make_unique<SharpenedNormals>(*state->iterated, *state->normals);
  }
  if (cloud.has_colors()) state->colors.emplace(cloud);
  progress.finish();
  return SurfaceModel(std::move(state));
}

SurfaceModel make_surface_model(SurfaceFunction function) {
  auto state = std::make_unique<SurfaceModel::State>();
  state->cloud.points = *function.samples;
  state->cloud.place = function.place;
  state->report.method = SurfaceMethod::partition;
  state->report.samples = state->cloud.points.size();
  state->partition = std::move(function.field);
  state->use_partition();
  if (state->cloud.points.has_colors()) state->colors.emplace(state->cloud.points);
  return SurfaceModel(std::move(state));
}

SurfaceModel::SurfaceModel(std::unique_ptr<State> state) : state_(std::move(state)) {}
SurfaceModel::~SurfaceModel() = default;
SurfaceModel::SurfaceModel(SurfaceModel&&) noexcept = default;
SurfaceModel& SurfaceModel::operator=(SurfaceModel&&) noexcept = default;

const Placement& SurfaceModel::place() const { return state_->cloud.place; }
const ScalarField& SurfaceModel::field(Progress& progress) const {
  std::call_once(state_->field_made, [&] { state_->make_field(progress); });
  return *state_->field;
}
const NormalField* SurfaceModel::normals() const {
  if (state_->sharpened) return state_->sharpened.get();
  if (state_->iterated) return &*state_->iterated;
  return state_->normals ? &*state_->normals : nullptr;
}
bool SurfaceModel::creases() const {
  return state_->normals || (state_->mpu && state_->mpu->report().edges + state_->mpu->report().corners > 0);
}
bool SurfaceModel::closes_holes() const { return state_->partition || state_->mpu; }
const ScalarField* SurfaceModel::placement(Progress& progress) const {
  field(progress);
  return state_->placement ? &*state_->placement : nullptr;
}
const Projection* SurfaceModel::projection() const { return state_->projection ? &*state_->projection : nullptr; }
const BallUnion& SurfaceModel::balls() const { return state_->balls; }
double SurfaceModel::jump() const {
  return state_->report.method == SurfaceMethod::hoppe ? kJumpOfPatches : kJumpOfOthers;
}
const PointSet& SurfaceModel::points() const { return state_->cloud.points; }
const ColorField* SurfaceModel::colors() const { return state_->colors ? &*state_->colors : nullptr; }
const SurfaceReport& SurfaceModel::report() const { return state_->report; }
const std::vector<std::string>& SurfaceModel::warnings() const { return state_->cloud.warnings; }

BlockTree SurfaceModel::State::blocks(double coarseness, const std::optional<Flatness>& flat) const {
  std::vector<float> radii = balls.radii;
  for (float& r : radii) r *= static_cast<float>(kBlockReach);
  // Of the partition, the supports themselves tell how fine it is: about four blocks across.
  const auto spacing_at = [&](std::uint32_t i) {
    return static_cast<double>(spacing.empty() ? balls.radii[i] / 4 : spacing[i]);
  };
  const BallTree near(balls.centers, radii);
  const Box3 box = bounds();
  const Vec3 size = box.size();
  const double edge = 1.02 * std::max({size.x, size.y, size.z});
  const Vec3 middle = box.center();
  BlockTree tree(middle - Vec3{edge, edge, edge} * 0.5, edge);
  const auto divides = [&](std::size_t block, std::vector<std::uint32_t>& touched) {
    const double e = tree.block_edge(block);
    const auto touching = [&](double margin) {
      const double half = (0.5 + margin) * e;
      const Vec3 center = tree.block_center(block), h{half, half, half};
      near.touching({Vec3f(center - h), Vec3f(center + h)}, touched);
    };
    touching(0);
    if (touched.empty()) return false;
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t i : touched) least = std::min(least, spacing_at(i));
    const double finest = kBlockEdge * std::max(1.0, flat ? report.smoothing : 0) * coarseness * least;
    if (!flat) return e > finest;
    if (e > kLargest * finest) return true;
    touching(kFlatMargin);
    // Smoothing leaves nothing finer along the surface, but does not make walls thicker. Sharp edges of wedges are
    // placed better with triangles no finer than what the samples tell.
    if (e <= finest) return e > kThinBlockEdge * coarseness * least && !normals && flat->two_sided(touched);
    return !flat->holds(touched);
  };
  // Level by level: each block decides by itself.
  std::vector<std::size_t> level{0}, next;
  for (int depth = 0; depth < kDeepest && !level.empty(); ++depth) {
    std::vector<std::uint8_t> divided(level.size());
    parallel_ranges(0, level.size(), 64, [&](std::size_t first, std::size_t last) {
      std::vector<std::uint32_t> touched;
      for (std::size_t i = first; i < last; ++i) divided[i] = divides(level[i], touched);
    });
    next.clear();
    for (std::size_t i = 0; i < level.size(); ++i) {
      if (!divided[i]) continue;
      const std::size_t first = tree.subdivide(level[i]);
      for (std::size_t k = 0; k < 8; ++k) next.push_back(first + k);
    }
    level.swap(next);
  }
  return tree;
}

BlockTree SurfaceModel::blocks(double coarseness) const {
  if (!(coarseness > 0)) throw ArgumentError("coarseness must be positive");
  return state_->blocks(coarseness, {});
}

PointSet SurfaceModel::feet(Progress& progress) const {
  const ScalarField& f = field(progress);
  progress.begin("find feet");
  const BallUnion& balls = state_->balls;
  std::vector<Vec3> x(balls.centers.begin(), balls.centers.end()), g(x.size());
  std::vector<double> values(x.size());
  PointSet feet;
  feet.positions.resize(x.size()), feet.normals.resize(x.size());
  for (int step = 0; step < kFootSteps; ++step) {
    f.evaluate(x, values, g);
    parallel_for(0, x.size(), 4096, [&](std::size_t i) {
      const double slope = norm(g[i]), most = static_cast<double>(balls.radii[i]);
      if (!(slope > 0)) return;
      const Vec3 n = g[i] / slope;
      x[i] -= n * std::clamp(values[i] / slope, -most, most);
      feet.normals[i] = Vec3f(n);
    });
  }
  for (std::size_t i = 0; i < x.size(); ++i) feet.positions[i] = Vec3f(x[i]);
  progress.finish();
  return feet;
}

BlockTree SurfaceModel::blocks_for(const PointSet& feet, double mesh_error) const {
  if (!(mesh_error > 0)) throw ArgumentError("`mesh_error` must be positive");
  if (feet.size() != state_->balls.centers.size() || feet.normals.size() != feet.size())
    throw ArgumentError("the feet must be those of the surface");
  if (state_->partition) return blocks(1);
  return state_->blocks(1, Flatness{feet, mesh_error});
}

std::vector<Vec3> SurfaceModel::seeds() const {
  if (state_->partition) return state_->partition->seeds();
  return {state_->balls.centers.begin(), state_->balls.centers.end()};
}

}  // namespace sansmesh
