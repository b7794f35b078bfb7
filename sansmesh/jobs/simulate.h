// A body of tetrahedra that moves by forces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sansmesh/dynamics/soft_body.h"
#include "sansmesh/jobs/motion.h"
#include "sansmesh/jobs/plan_simulation.h"
#include "sansmesh/note.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

/// A moment of a simulation, after a step.
struct SimulationMoment {
  BodyEnergies energies;
  StepReport step;
};

struct SimulateReport {
  std::size_t steps = 0, halvings = 0;
  std::size_t unsettled = 0;     ///< steps after which contacts would still change
  std::uint64_t iterations = 0;  ///< of conjugate gradients
  double shortest_step = 0;      ///< s
  int most_contacts = 0;
  double seconds = 0;  ///< that it took
  BodyEnergies first, last;
  std::vector<SimulationMoment> moments;  ///< at rest, and where they are asked for after each step

  static const ReportSchema& schema();
  /// A table (CSV) of all moments: energies, iterations, contacts.
  std::string table() const;
};

/// What was simulated and how long that took, in lines for people.
std::vector<std::string> summary_of(const SimulationPlan& plan, const SimulateReport& report);

struct SimulateResult {
  std::shared_ptr<const Motion> motion;
  SimulateReport report;
  /// "within_obstacle": vertices begin in one; "unstable_step": longer than the integrator bears; "halved": conjugate
  /// gradients did not converge; "unsettled": contacts changed until the ends of many steps.
  std::vector<Note> notes;
};

/// Moves the body as planned; the moments of all steps are kept where `moments` says so. Throws SceneError for scenes
/// that cannot be, ArgumentError for frames that would take too much memory, DataError where the body explodes,
/// Cancelled.
SimulateResult simulate(const SimulationPlan& plan, const KeptMotion& kept, bool moments, Progress& progress);

}  // namespace sansmesh::inline v1
