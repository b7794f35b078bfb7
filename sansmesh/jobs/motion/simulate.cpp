// Simulation of a tetrahedral body.
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/dynamics/body_integrator.h"
#include "sansmesh/dynamics/scene_script.h"
#include "sansmesh/dynamics/soft_body.h"
#include "sansmesh/jobs/motion/scene_errors.h"
#include "sansmesh/simulate.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kMostBytes = 8e9;      ///< limit of frames in memory
constexpr double kManyUnsettled = 0.1;  ///< share of the steps

SoftBody body_of_plan(const SimulationPlan& plan) {
  TetMesh metres{plan.rest->vertices, plan.rest->tets, {}, {}};
  for (Vec3& p : metres.vertices) p *= plan.unit;
  try {
    return {std::move(metres), plan.options, scaled(plan.scene, plan.unit)};
  } catch (const ArgumentError& error) {
    throw SceneError(error.what());
  }
}

void note_start(const SoftBody& body, std::vector<Note>& notes) {
  const std::size_t within = body.within_obstacles().size();
  if (within == 0) return;
  notes.push_back({.code = "within_obstacle",
                   .text = fmt::format("{} within an obstacle: they may be thrown out at high speed",
                                       within == 1 ? "1 vertex starts" : grouped(within) + " vertices start")});
}

void note_steps(const SimulationPlan& plan, double stable, const SimulateReport& r, std::vector<Note>& notes) {
  // Explosions throw an error of their own.
  if (plan.options.step > stable)
    notes.push_back({.code = "unstable_step",
                     .text = fmt::format("steps of {:.3g} s exceed the stability limit of {} ({:.2g} s)",
                                         plan.options.step, plan.options.integrator, stable)});
  if (r.halvings > 0)
    notes.push_back(
        {.code = "halved",
         .text = fmt::format("the step was halved {} times, down to {:.4g} s: conjugate gradients did not converge",
                             grouped(r.halvings), r.shortest_step),
         .remedy = "a smaller `longest_step`, or less `stiffness`, is faster"});
  if (static_cast<double>(r.unsettled) > kManyUnsettled * static_cast<double>(r.steps))
    notes.push_back({.code = "unsettled",
                     .text = fmt::format("contacts were still changing at the end of {} of {} steps",
                                         grouped(r.unsettled), grouped(r.steps)),
                     .remedy = "reduce `longest_step`"});
}

/// Computes all frames after the first.
void move(SoftBody& body, const SimulationPlan& plan, bool moments, Motion& motion, SimulateReport& r,
          Progress& progress) {
  const double h = plan.frame_time / static_cast<double>(plan.frame_steps);
  progress.begin("simulating", (plan.frames - 1) * plan.frame_steps);
  for (std::size_t frame = 1; frame < plan.frames; ++frame) {
    for (std::size_t k = 0; k < plan.frame_steps; ++k) {
      const StepReport step = body.advance(h);
      ++r.steps;
      r.halvings += static_cast<std::size_t>(step.halvings);
      r.unsettled += step.unsettled > 0;
      r.iterations += static_cast<std::uint64_t>(step.iterations);
      r.shortest_step = std::min(r.shortest_step, step.shortest);
      r.most_contacts = std::max(r.most_contacts, step.contacts);
      if (moments) r.moments.push_back({body.energies(), step});
      progress.advance();
    }
    motion.add(static_cast<double>(frame) * plan.frame_time, body.positions(), body.velocities(), plan.unit);
  }
  progress.finish();
}

SimulateResult simulate_plan(const SimulationPlan& plan, const KeptMotion& kept, bool moments, Progress& progress) {
  Motion motion(plan.rest, kept);
  if (const double bytes = motion.bytes(plan.frames); bytes > kMostBytes)
    throw ArgumentError(fmt::format("{} frames of {} vertices need {:.1f} GB: use fewer `frames`", grouped(plan.frames),
                                    grouped(plan.rest->vertices.size()), 1e-9 * bytes));
  SimulateResult result;
  SimulateReport& r = result.report;
  SoftBody body = body_of_plan(plan);
  const double stable = plan.step_given ? body.stable_step() : plan.options.step;
  note_start(body, result.notes);
  r.first = body.energies();
  r.shortest_step = std::numeric_limits<double>::infinity();
  r.moments.push_back({r.first, {}});
  motion.add(0, body.positions(), body.velocities(), plan.unit);
  const auto begin = std::chrono::steady_clock::now();
  move(body, plan, moments, motion, r, progress);
  r.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  r.last = body.energies();
  note_steps(plan, stable, r, result.notes);
  result.motion = motion;
  return result;
}

}  // namespace

SimulateResult simulate(const SimulationPlan& plan, const KeptMotion& kept, bool moments, Progress& progress) {
  return with_files(plan.body_file, plan.scene_file, [&] { return simulate_plan(plan, kept, moments, progress); });
}

const ReportSchema& SimulateReport::schema() {
  static constexpr ReportRow rows[] = {
      reported<&SimulateReport::steps>({.text = "Steps"}),
      reported<&SimulateReport::iterations>({.text = "Iterations of conjugate gradients"}),
      reported<&SimulateReport::halvings>({.text = "Halvings of steps"}),
      reported<&SimulateReport::unsettled>({.text = "Steps whose contacts would still change"}),
      reported<&SimulateReport::shortest_step>({.text = "Shortest step", .unit = "s"}),
      reported<&SimulateReport::most_contacts>({.text = "Most vertices in contact with obstacles"}),
      reported<&SimulateReport::seconds>({.text = "Run time", .unit = "s"}),
      reported<&SimulateReport::first>({.name = "energies.first", .text = "Initial energies"}),
      reported<&SimulateReport::last>({.name = "energies.last", .text = "Final energies"})};
  return report_schema<rows>();
}

namespace {

std::string material_words(const SoftBodyOptions& o) {
  return o.model == SoftBodyModel::springs
             ? fmt::format("springs of {:.4g} N/m, damping {:.4g} N s/m", o.stiffness, o.damping)
             : fmt::format("Young's modulus {:.4g} Pa, Poisson's ratio {:.4g}, damping {:.4g} s", o.young, o.poisson,
                           o.stiffness_damping);
}

}  // namespace

std::string SimulateReport::table() const {
  std::string table = "time,kinetic,elastic,gravity,total,iterations,step,contacts\n";
  for (const auto& [e, step] : moments)
    table += fmt::format("{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{},{:.6g},{}\n", step.time, e.kinetic, e.elastic,
                         e.gravity, e.total(), step.iterations, step.shortest, step.contacts);
  return table;
}

std::vector<std::string> summary_of(const SimulationPlan& plan, const SimulateReport& r) {
  const SoftBodyOptions& options = plan.options;
  const double steps = static_cast<double>(r.steps);
  return {fmt::format("{}: {} vertices, {} tetrahedra, {} fixed", plan.body_file.empty() ? "the body" : plan.body_file,
                      grouped(plan.rest->vertices.size()), grouped(plan.rest->tets.size()),
                      grouped(plan.scene.fixed.size())),
          fmt::format("{} ({}), {}", word_of(options.model), material_words(options), options.integrator),
          fmt::format("{} of at most {:.4g} s in {:.3g} s ({:.1f} per second){}", counted(r.steps, "step"),
                      options.step, r.seconds, steps / std::max(r.seconds, 1e-9),
                      body_integrator(options.integrator).is_implicit
                          ? fmt::format(", {:.1f} iterations per step", static_cast<double>(r.iterations) / steps)
                          : ""),
          fmt::format("energy {:.6g} J initially, {:.6g} J finally (kinetic {:.4g}, elastic {:.4g}, gravity {:.4g})",
                      r.first.total(), r.last.total(), r.last.kinetic, r.last.elastic, r.last.gravity),
          fmt::format("{} of {:.4g} s", counted(plan.frames, "frame"), plan.frame_time)};
}

}  // namespace sansmesh::inline v1
