#include "sansmesh/model/surface_model.h"
#include "sansmesh/option.h"
#include "sansmesh/surface_options.h"

#include <fmt/core.h>

#include <algorithm>
#include <mutex>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/model/methods/partition_methods.h"
#include "sansmesh/model/surface_blocks.h"
#include "sansmesh/points/sampling/sample_colors.h"
#include "sansmesh/surface/bilateral_normals.h"

namespace sansmesh::inline v1 {
namespace {

/// Newton steps from a sample to the surface.
constexpr int kFootSteps = 2;
/// Normals of the method, refined by the sharp ones.
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

/// Options with lengths in the coordinates of a prepared cloud.
SurfaceOptions in_local_frame(SurfaceOptions options, const LocalFrame& frame) {
  for_each_option(SurfaceOptions::schema(), &options, [&](const OptionRow& row, void* owner) {
    const OptionValue value = row.get(owner);
    const auto* const length = row.unit == "length" ? std::get_if<double>(&value) : nullptr;
    if (length) row.set(owner, frame.from_input(*length));
  });
  return options;
}

BilateralOptions sharp_options(const SurfaceOptions& options) {
  BilateralOptions o;
  o.formula = *options.sharp, o.weights = options.weights;
  if (o.formula == SharpFormula::laguerre) {  // uses h and ε of the surface
    o.epsilon = options.epsilon.value_or(o.epsilon);
    o.smoothing = options.smoothing, o.bandwidth = options.bandwidth;
  }
  return o;
}

}  // namespace

struct SurfaceModel::State {
  PreparedCloud cloud;
  SurfaceReport report;
  SurfaceParts parts;
  mutable std::once_flag field_made;
  mutable std::shared_ptr<const ScalarField> field;  // field of a projection: created on first use
  mutable std::optional<FaceField> placement;
  std::optional<BilateralNormals> sharp;
  std::optional<SharpenedNormals> sharpened;  // applied to the method's own normals
  std::optional<SampleColors> colors;

  void take(SurfaceParts made, std::string_view method);
  /// Data that only polygonizers need: for a projection, a field that also classifies points too far away to be
  /// projected; and the field for placing vertices of sharp meshes.
  void make_field(Progress& progress) const {
    field = parts.field ? parts.field : parts.make_field(progress);
    if (sharp) placement.emplace(*field, *sharp);
  }
  SurfaceSupport support() const {
    return {.balls = parts.support,
            .spacings = parts.spacings,
            .bounds = parts.projection ? parts.projection->bounds() : parts.field->bounds(),
            .smoothing = report.smoothing,
            .sharp = sharp.has_value()};
  }
};

void SurfaceModel::State::take(SurfaceParts made, std::string_view method) {
  parts = std::move(made);
  report = {.method = std::string(method),
            .spacing = cloud.frame.to_input(parts.spacing),
            .noise = cloud.frame.to_input(parts.noise),
            .smoothing = parts.smoothing,
            .order = parts.order,
            .iterations = parts.iterations,
            .samples = cloud.points.size()};
  if (cloud.points.has_colors()) colors.emplace(cloud.points);
}

SurfaceModel make_surface_model(PointSet points, const SurfaceOptions& options, Progress& progress) {
  options.validate();
  return make_surface_model(prepare_cloud(std::move(points), {}, progress), options, progress);
}

SurfaceModel make_surface_model(PreparedCloud prepared, const SurfaceOptions& options, Progress& progress) {
  options.validate();
  auto state = std::make_unique<SurfaceModel::State>();
  state->cloud = std::move(prepared);
  if (options.sharp) sharpen_estimated_normals(state->cloud, progress);
  const SurfaceOptions inner = in_local_frame(options, state->cloud.frame);
  state->take(surface_method(options.method).make(state->cloud, inner, progress), options.method);
  if (options.sharp) {
    if (!state->parts.samples) throw ArgumentError("`sharp` means nothing to the surface " + options.method);
    state->sharp.emplace(*state->parts.samples, sharp_options(inner));
    if (state->parts.normals) state->sharpened.emplace(*state->parts.normals, *state->sharp);
  }
  progress.finish();
  return SurfaceModel(std::move(state));
}

SurfaceModel make_surface_model(FittedFunction function) {
  auto state = std::make_unique<SurfaceModel::State>();
  state->cloud.points = *function.samples;
  state->cloud.frame = function.frame;
  state->take(partition_parts(std::move(function.field)), kPartitionSurface);
  return SurfaceModel(std::move(state));
}

SurfaceModel::SurfaceModel(std::unique_ptr<State> state) : state_(std::move(state)) {}
SurfaceModel::~SurfaceModel() = default;
SurfaceModel::SurfaceModel(SurfaceModel&&) noexcept = default;
SurfaceModel& SurfaceModel::operator=(SurfaceModel&&) noexcept = default;

const LocalFrame& SurfaceModel::frame() const { return state_->cloud.frame; }
const ScalarField& SurfaceModel::field(Progress& progress) const {
  std::call_once(state_->field_made, [&] { state_->make_field(progress); });
  return *state_->field;
}
const NormalField* SurfaceModel::normals() const {
  if (state_->sharpened) return &*state_->sharpened;
  return state_->sharp ? &*state_->sharp : state_->parts.normals.get();
}
SurfaceTraits SurfaceModel::traits() const {
  SurfaceTraits traits = state_->parts.traits;
  traits.creases = traits.creases || state_->sharp;
  return traits;
}
const ScalarField* SurfaceModel::placement(Progress& progress) const {
  field(progress);
  return state_->placement ? &*state_->placement : nullptr;
}
const Projection* SurfaceModel::projection() const { return state_->parts.projection.get(); }
const BallUnion& SurfaceModel::balls() const { return state_->parts.support; }
const PointSet& SurfaceModel::points() const { return state_->cloud.points; }
const ColorField* SurfaceModel::colors() const { return state_->colors ? &*state_->colors : nullptr; }
const SurfaceReport& SurfaceModel::report() const { return state_->report; }
const std::vector<Note>& SurfaceModel::notes() const { return state_->cloud.notes; }

BlockTree SurfaceModel::blocks(double coarseness) const {
  if (!(coarseness > 0)) throw ArgumentError("coarseness must be positive");
  return surface_blocks(state_->support(), coarseness);
}

PointSet SurfaceModel::feet(Progress& progress) const {
  const ScalarField& f = field(progress);
  progress.begin("find feet");
  const BallUnion& balls = state_->parts.support;
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
  if (feet.size() != balls().centers.size() || feet.normals.size() != feet.size())
    throw ArgumentError("the feet must be those of the surface");
  if (state_->parts.spacings.empty()) return blocks(1);
  return surface_blocks(state_->support(), 1, FlatSurface{feet, mesh_error});
}

std::vector<Vec3> SurfaceModel::seeds() const {
  if (state_->parts.seeds) return state_->parts.seeds();
  return {balls().centers.begin(), balls().centers.end()};
}

namespace {

constexpr ReportRow kSurfaceReportRows[] = {
    reported<&SurfaceReport::method>({.text = "Name of the method"}),
    reported<&SurfaceReport::spacing>({.text = "Spacing of the samples", .unit = "length"}),
    reported<&SurfaceReport::noise>({.text = "Noise of the samples", .unit = "length"}),
    reported<&SurfaceReport::smoothing>({.text = "Median width of the weights; 0 without weights", .unit = "spacings"}),
    reported<&SurfaceReport::order>({.text = "Order of the approximation, of amls"}),
    reported<&SurfaceReport::iterations>({.text = "Iterations of the approximation, of amls"})};

}  // namespace

const ReportSchema& SurfaceReport::schema() {
  static constexpr ReportSchema schema{kSurfaceReportRows};
  return schema;
}

std::vector<std::string> summary_of(const SurfaceReport& r) {
  std::vector<std::string> lines{fmt::format("{}, {}, spacing {}, noise {}", counted(r.samples, "sample"), r.method,
                                             length_words(r.spacing), length_words(r.noise))};
  if (!(r.smoothing > 0)) return lines;
  lines.push_back(fmt::format("weights {:.2f} spacings wide", r.smoothing));
  if (surface_method(r.method).uses_option("order"))
    lines.back() += fmt::format(", order {}, {}", r.order, counted(static_cast<unsigned>(r.iterations), "iteration"));
  return lines;
}

}  // namespace sansmesh::inline v1
