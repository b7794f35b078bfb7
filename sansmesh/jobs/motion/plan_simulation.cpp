// Planning of simulations.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/dynamics/body_integrator.h"
#include "sansmesh/dynamics/recommended_options.h"
#include "sansmesh/dynamics/scene_script.h"
#include "sansmesh/error.h"
#include "sansmesh/jobs/motion/scene_errors.h"
#include "sansmesh/schema/registry_words.h"
#include "sansmesh/simulate.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kDefaultDuration = 2, kDefaultRate = 25;
constexpr double kMostFrames = 100000, kMostSteps = 1e8;
constexpr double kLeastSize = 1e-6, kMostSize = 1e9;  ///< range of body sizes, m
constexpr double kFloorBelow = 0.3;  ///< distance of the default floor below the body, as a share of its height

template <class T>
void override_by(std::optional<T>& value, const std::optional<T>& option) {
  if (option) value = option;
}

/// Uses the mean materials of the cells for values that are not given.
void take_material(const TetMesh& body, SceneScript& s, std::vector<Note>& notes) {
  const AttributeTable& arrays = body.tet_attributes;
  const auto* const density = arrays.find<double>("density");
  const auto* const young = arrays.find<double>("young");
  const auto* const poisson = arrays.find<double>("poisson");
  if (!density || !young || !poisson) return;
  double sum[3] = {};
  std::size_t known = 0;
  bool differ = false;
  std::array<double, 3> first{};
  for (std::size_t t = 0; t < density->size(); ++t) {
    const std::array<double, 3> m{(*density)[t], (*young)[t], (*poisson)[t]};
    if (std::isnan(m[0]) || std::isnan(m[1]) || std::isnan(m[2])) continue;
    if (!(m[0] > 0 && m[1] > 0 && m[2] >= 0 && m[2] <= 0.49 && std::isfinite(m[0]) && std::isfinite(m[1])))
      throw DataError(
          fmt::format("the material of a cell cannot be simulated (density {:g}, Young's modulus {:g} Pa, "
                      "Poisson's ratio {:g}): the first two must be above 0, the third in 0..0.49",
                      m[0], m[1], m[2]));
    if (known++ == 0) first = m;
    differ = differ || m != first;
    for (std::size_t k = 0; k < 3; ++k) sum[k] += m[k];
  }
  if (known == 0) return;
  const bool springs = s.model == SoftBodyModel::springs || s.stiffness;
  const bool taken = !s.density || (!springs && (!s.young || !s.poisson));
  const auto mean = [&](std::size_t k, std::optional<double>& value) {
    if (!value) value = differ ? sum[k] / static_cast<double>(known) : first[k];
  };
  mean(0, s.density);
  if (!springs) mean(1, s.young), mean(2, s.poisson);
  if (taken && differ) notes.push_back({.code = "mean_material", .text = "several materials: the body has their mean"});
  if (taken && known < density->size())
    notes.push_back({.code = "no_material",
                     .text = fmt::format("{} without a material: they have that of the others",
                                         counted(density->size() - known, "cell"))});
}

/// Overrides the scene by options.
void override_scene(const SimulateOptions& o, SceneScript& s) {
  override_by(s.model, o.model);
  override_by(s.integrator, o.integrator);
  override_by(s.step, o.longest_step), override_by(s.duration, o.duration);
  override_by(s.frames_per_second, o.fps);
  override_by(s.stiffness, o.stiffness), override_by(s.young, o.young), override_by(s.poisson, o.poisson);
  override_by(s.density, o.density);
  if (o.unit) s.unit = o.unit->metres;
  if (o.z_up) s.z_up = true;
}

void take_unit(const TetMesh& body, SceneScript& s, std::vector<Note>& notes) {
  const double unit = recommended_unit(s, body);
  const double size = bounds(body).diagonal();
  if (!s.unit && unit != 1)
    notes.push_back({.code = "unit",
                     .text = fmt::format("{:.4g} long in an unknown unit: interpreted as {}, {:.3g} m", size,
                                         unit == 0.01 ? "centimetres" : "millimetres", size * unit),
                     .remedy = "`unit` sets another"});
  s.unit = unit;
  if (!(size * unit >= kLeastSize && size * unit <= kMostSize))
    throw DataError(
        fmt::format("is {:.3g} m large, which cannot be simulated: set the `unit` of lengths", size * unit));
}

/// Adds a floor if one is requested, or if nothing else stops the fall of the body.
void add_floor_below(SceneScript& s, const TetMesh& body, const Vec3& gravity) {
  const bool falls = s.scene.fixed.empty() && s.scene.handles.empty() && s.scene.floors.empty() &&
                     s.scene.spheres.empty() && !s.no_floor;
  if (!s.floor_below && !falls) return;
  if (!(norm(gravity) > 0)) return;
  const Vec3 up = -normalized(gravity);
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (const Vec3& p : body.vertices) {
    lowest = std::min(lowest, dot(p, up));
    highest = std::max(highest, dot(p, up));
  }
  FloorObstacle floor;
  floor.normal = up;
  floor.point = up * (lowest - kFloorBelow * (highest - lowest));
  floor.friction = s.friction.value_or(kUsualFriction);
  s.scene.floors.push_back(floor);
}

/// Times of the frames.
void plan_frames(const SimulateOptions& o, const SceneScript& s, SimulationPlan& plan) {
  double rate = s.frames_per_second.value_or(kDefaultRate);
  double time = s.duration.value_or(kDefaultDuration);
  if (o.frames) {
    const double steps = *o.frames - 1;
    if (o.fps || !s.duration)
      time = steps / rate;
    else
      rate = steps / time;
  }
  // Rounds to whole frames at the given rate; a given number of frames is kept exactly.
  const double frames = o.frames ? *o.frames - 1 : std::floor(time * rate * (1 + 1e-9));
  if (!(frames >= 1))
    throw ArgumentError(fmt::format("a `duration` of {:g} s is shorter than a frame ({:g} per second)", time, rate));
  if (frames > kMostFrames)
    throw ArgumentError(
        fmt::format("{:g} s with {:g} frames per second are more than {:g} frames", time, rate, kMostFrames));
  plan.frames = whole_part<std::size_t>(frames) + 1;
  plan.frame_time = 1 / rate;
}

void plan_steps(SimulationPlan& plan) {
  const double steps = std::max(1.0, std::ceil(plan.frame_time / plan.options.step - 1e-9));
  if (!(steps * static_cast<double>(plan.frames - 1) <= kMostSteps))
    throw ArgumentError(
        fmt::format("a `longest_step` of {:.3g} s gives more than {:g} steps", plan.options.step, kMostSteps));
  plan.frame_steps = whole_part<std::size_t>(steps);
}

/// Converts errors of values that no option set to SceneError.
template <class Work>
void with_scene_errors(bool by_options, const Work& work) {
  try {
    work();
  } catch (const ArgumentError& error) {
    if (by_options) throw;
    throw SceneError(error.what());
  }
}

}  // namespace

const OptionSchema& SimulateOptions::schema() {
  using O = SimulateOptions;
  using Integrators = RegistryWords<BodyIntegrator>;
  static const std::string integrators = "Time integrator: " + registry_summaries<BodyIntegrator>();
  static const OptionRow rows[] = {
      option<&O::model>({.text = "Material: every edge a spring (springs), or corotational elasticity (corotational)",
                         .from_data = "springs, unless `young` is given",
                         .choices = kModelWords}),
      option<&O::stiffness>(
          {.text = "Stiffness of springs", .unit = "N/m", .from_data = "the body", .range = positive()}),
      option<&O::young>(
          {.text = "Young's modulus", .unit = "Pa", .from_data = "the file's, else the body", .range = positive()}),
      option<&O::poisson>(
          {.text = "Poisson's ratio", .unit = "ratio", .from_data = "the file's, else 0.3", .range = {0, 0.49}}),
      option<&O::damping>({.text = "Damping of springs, N s/m; of elasticity, s",
                           .from_data = "0.004 s of the stiffness",
                           .range = at_least(0)}),
      option<&O::density>(
          {.text = "Density", .unit = "kg/m³", .from_data = "the file's, else 1000", .range = positive()}),
      option<&O::unit>(
          {.text = "Unit of lengths in the body's file and the scene: mm, cm, dm, m, km, inch, foot or metres",
           .from_data = "m; cm or mm for bodies larger than 20"}),
      option<&O::duration>(
          {.text = "Simulated time", .unit = "seconds", .from_data = "2", .range = positive(), .old_name = "time"}),
      option<&O::fps>({.text = "Frames per second", .unit = "1/s", .from_data = "25", .range = positive()}),
      option<&O::frames>({.text = "Number of frames, the initial one included", .range = at_least(2)}),
      option<&O::integrator, Integrators>(
          {.text = integrators, .from_data = "implicit-euler", .choices = Integrators::names()}),
      option<&O::longest_step>({.text = "Longest step",
                                .unit = "seconds",
                                .from_data = "0.01; half the stability limit for explicit ones",
                                .range = positive(),
                                .old_name = "step"}),
      option<&O::z_up>({.text = "Gravity pulls along -z, regardless of the scene"})};
  return option_schema<rows>();
}

void SimulateOptions::validate() const {
  validate_options(*this);
  if (frames && fps && duration) throw ArgumentError("only two of `frames`, `fps` and `duration` can be given");
}

SimulationPlan plan_simulation(TetMesh body, SceneScript scene, const SimulateOptions& options) {
  options.validate();
  SimulationPlan plan;
  std::vector<std::uint32_t>& fixed = scene.scene.fixed;
  std::sort(fixed.begin(), fixed.end());
  fixed.erase(std::unique(fixed.begin(), fixed.end()), fixed.end());
  override_scene(options, scene);
  take_material(body, scene, plan.notes);
  if (scene.stiffness && !scene.model) scene.model = SoftBodyModel::springs;
  if (options.damping) scene.damping = scene.stiffness_damping = options.damping;
  take_unit(body, scene, plan.notes);
  plan.unit = *scene.unit;
  plan.z_up = scene.z_up.value_or(false);
  plan.step_given = scene.step.has_value();

  TetMesh metres{body.vertices, body.tets, {}, {}};
  for (Vec3& p : metres.vertices) p *= plan.unit;
  with_scene_errors(options.frames || options.duration || options.fps, [&] { plan_frames(options, scene, plan); });
  with_scene_errors(false, [&] {
    plan.options = recommended_options(scene, metres);
    plan.options.validate();
  });
  with_scene_errors(options.longest_step.has_value(), [&] { plan_steps(plan); });
  add_floor_below(scene, body, plan.options.gravity);
  plan.scene = std::move(scene.scene);
  plan.rest = std::make_shared<const TetMesh>(std::move(body));
  return plan;
}

SimulationPlan plan_simulation(const SimulationBody& body, SceneScript scene, const SimulateOptions& options) {
  const std::string scene_file = scene.file;
  SimulationPlan plan =
      with_files(body.file, scene_file, [&] { return plan_simulation(body.mesh(), std::move(scene), options); });
  plan.body_file = body.file, plan.scene_file = scene_file;
  return plan;
}

namespace {

constexpr ReportRow kSimulationPlanRows[] = {
    reported<[](const SimulationPlan& r) { return r.rest->vertices.size(); }>(
        {.name = "input.vertices", .text = "Vertices of the body"}),
    reported<[](const SimulationPlan& r) { return r.rest->tets.size(); }>(
        {.name = "input.tetrahedra", .text = "Tetrahedra of the body"}),
    reported<[](const SimulationPlan& r) { return r.scene.fixed.size(); }>(
        {.name = "scene.fixed", .text = "Fixed vertices"}),
    reported<[](const SimulationPlan& r) { return r.scene.forces.size(); }>({.name = "scene.forces", .text = "Forces"}),
    reported<[](const SimulationPlan& r) { return r.scene.handles.size(); }>(
        {.name = "scene.handles", .text = "Handles"}),
    reported<[](const SimulationPlan& r) { return r.scene.floors.size(); }>({.name = "scene.floors", .text = "Floors"}),
    reported<[](const SimulationPlan& r) { return r.scene.spheres.size(); }>(
        {.name = "scene.spheres", .text = "Spheres"}),
    reported<&SimulationPlan::unit>({.name = "scene.unit", .text = "Unit of lengths in metres", .unit = "m"}),
    reported<[](const SimulationPlan& r) { return r.options.gravity; }>(
        {.name = "scene.gravity", .text = "Gravity", .unit = "m/s²"}),
    reported<[](const SimulationPlan& r) { return r.options.model; }>(
        {.name = "model", .text = "Model of the material", .choices = kModelWords}),
    reported<[](const SimulationPlan& r) { return r.options.integrator; }>(
        {.name = "integrator", .text = "Integrator"}),
    reported<[](const SimulationPlan& r) { return r.options.stiffness; }>(
        {.name = "stiffness", .text = "Stiffness of springs", .unit = "N/m"}),
    reported<[](const SimulationPlan& r) { return r.options.damping; }>(
        {.name = "damping", .text = "Damping of springs", .unit = "N s/m"}),
    reported<[](const SimulationPlan& r) { return r.options.young; }>(
        {.name = "young", .text = "Young's modulus", .unit = "Pa"}),
    reported<[](const SimulationPlan& r) { return r.options.poisson; }>({.name = "poisson", .text = "Poisson's ratio"}),
    reported<[](const SimulationPlan& r) { return r.options.stiffness_damping; }>(
        {.name = "stiffness_damping", .text = "Damping of the elastic material", .unit = "s"}),
    reported<[](const SimulationPlan& r) { return r.options.density; }>(
        {.name = "density", .text = "Density", .unit = "kg/m³"}),
    reported<[](const SimulationPlan& r) { return r.options.step; }>(
        {.name = "step", .text = "Longest step", .unit = "s"}),
    reported<&SimulationPlan::frames>({.name = "output.frames", .text = "Frames"}),
    reported<&SimulationPlan::frame_time>({.name = "output.frame_time", .text = "Time between frames", .unit = "s"})};

}  // namespace

const ReportSchema& SimulationPlan::schema() {
  // The registered integrators are known only at run time.
  static const std::vector<ReportRow> rows = [] {
    std::vector<ReportRow> all(std::begin(kSimulationPlanRows), std::end(kSimulationPlanRows));
    for (ReportRow& row : all)
      if (row.name == "integrator") row.choices = registry_names<BodyIntegrator>();
    return all;
  }();
  static const ReportSchema schema{rows};
  return schema;
}

}  // namespace sansmesh::inline v1
