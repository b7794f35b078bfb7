// An elastic body of tetrahedra (tejada2008, 6.4.5).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sansmesh/simulate_options.h"
#include "sansmesh/tet_mesh.h"

namespace sansmesh::inline v1 {

/// Positions and velocities are in the mesh's order and coordinates. Bit-identical for any number of threads.
class SoftBody {
 public:
  /// Starts at rest in the mesh's shape. Throws ArgumentError for bad options and scenes, DataError for unusable meshes
  /// (check_tets). Vertices without a tetrahedron have no mass and stay in place.
  SoftBody(TetMesh mesh, const SoftBodyOptions& options, DynamicsScene scene = {});
  ~SoftBody();
  SoftBody(SoftBody&&) noexcept;
  SoftBody& operator=(SoftBody&&) noexcept;

  /// Advances by options().step. Throws DataError with a remedy if the body explodes (positions not finite, an edge
  /// stretched to more than 1000 times its length), or conjugate gradients do not converge for any substep.
  StepReport step();

  /// Advances by `duration` > 0 seconds, in equal steps of at most options().step. The report covers all of them.
  StepReport advance(double duration);

  /// Approximately the longest step, s, with which options().integrator is stable for small motions about rest, from
  /// the fastest vibration by power iteration (stable_step.h): infinity for implicit Euler; for explicit Euler 0
  /// without damping, or if undamped springs hold handles. Rotating or loaded bodies need slightly less.
  double stable_step() const;

  /// Ascending indices of the vertices inside an obstacle by more than rounding; fixed vertices and those pulled
  /// without a stiffness do not count. Before the first step they indicate a fault of the scene: they are moved out at
  /// once, which throws the body. After a step there are none unless obstacles overlap.
  std::vector<std::uint32_t> within_obstacles() const;

  double time() const;  ///< elapsed time, s
  std::vector<Vec3> positions() const;
  std::vector<Vec3> velocities() const;
  BodyEnergies energies() const;
  const std::vector<double>& masses() const;  ///< kg, per vertex

  /// Continues from this state; one entry per vertex. Fixed and pulled vertices follow the scene.
  void set_state(std::span<const Vec3> positions, std::span<const Vec3> velocities);

  const TetMesh& rest() const;
  const SoftBodyOptions& options() const;
  const DynamicsScene& scene() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sansmesh::inline v1
