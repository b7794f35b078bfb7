// A body of tetrahedra that moves by forces (METHODS §7.2; thesis 6.4.5).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sansmesh/dynamics/soft_body_options.h"
#include "sansmesh/dynamics/step_report.h"
#include "sansmesh/report.h"
#include "sansmesh/tet_mesh.h"

namespace sansmesh::inline v1 {

/// Joules. Of gravity relative to the origin.
struct BodyEnergies {
  double kinetic = 0, elastic = 0, gravity = 0;
  double total() const { return kinetic + elastic + gravity; }

  static const ReportSchema& schema();
};

/// Positions and velocities are in the mesh's order and coordinates. The same bits for any number of threads.
class SoftBody {
 public:
  /// At rest where the mesh is. Throws ArgumentError for options and scenes, DataError for meshes that cannot be used
  /// (check_tets). Vertices without a tetrahedron have no mass and stay where they are.
  SoftBody(TetMesh mesh, const SoftBodyOptions& options, DynamicsScene scene = {});
  ~SoftBody();
  SoftBody(SoftBody&&) noexcept;
  SoftBody& operator=(SoftBody&&) noexcept;

  /// Time goes on by options().step. Throws DataError with a remedy where the body explodes (positions not finite, an
  /// edge stretched to more than 1000 times its length), or conjugate gradients do not converge however short the step.
  StepReport step();

  /// Time goes on by `duration` > 0 seconds, in equal steps of at most options().step. The report is of all of them.
  StepReport advance(double duration);

  /// About the longest step, s, with which options().integrator is stable for small motions about rest, by power
  /// iteration for the fastest vibration (stable_step.h): infinity of implicit Euler; of explicit Euler 0 where nothing
  /// damps, or handles hang on springs that nothing damps. Of what turns or is under load, a little less.
  double stable_step() const;

  /// Numbers, ascending, of the vertices, neither fixed nor pulled without a stiffness, that lie in an obstacle now, by
  /// more than rounding. Before the first step these are a fault of the scene: they are put out at once, which throws
  /// the body. After a step there are none, but where obstacles overlap.
  std::vector<std::uint32_t> within_obstacles() const;

  double time() const;  ///< s since the beginning
  std::vector<Vec3> positions() const;
  std::vector<Vec3> velocities() const;
  BodyEnergies energies() const;
  const std::vector<double>& masses() const;  ///< kg, of the vertices

  /// Goes on from there; as many of each as there are vertices. Fixed and pulled ones stay with the scene.
  void set_state(std::span<const Vec3> positions, std::span<const Vec3> velocities);

  const TetMesh& rest() const;
  const SoftBodyOptions& options() const;
  const DynamicsScene& scene() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sansmesh::inline v1
