// What a body of tetrahedra is made of, how it is integrated, and what acts on it. Units: SI, lengths in those of the
// mesh taken as metres.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

enum class SoftBodyModel : std::uint8_t {
  springs,       ///< every edge is a spring (METHODS §7.2; thesis 6.4.5)
  corotational,  ///< linear elasticity in each tetrahedron's own rotation: stiffness in pascals
};

enum class DynamicsIntegrator : std::uint8_t {
  explicit_euler,
  verlet,           ///< Störmer's, by positions: damping by the velocity of half a step before
  velocity_verlet,  ///< damping by velocities at the same moment
  implicit_euler,   ///< Baraff and Witkin's [baraff1998]: stable for stiff bodies and long steps
};

struct SoftBodyOptions {
  SoftBodyModel model = SoftBodyModel::springs;
  DynamicsIntegrator integrator = DynamicsIntegrator::implicit_euler;
  double step = 0.01;  ///< h, seconds, > 0

  // Springs.
  double stiffness = 3000;  ///< k_s of every edge, N/m, > 0
  double damping = 1;       ///< k_d: f = −k_d (v_i − v_j) along every edge, N s/m, >= 0

  // Corotational.
  double young = 1e5;            ///< Pa, > 0
  double poisson = 0.3;          ///< 0..0.49
  double mass_damping = 0;       ///< Rayleigh's α, 1/s, >= 0
  double stiffness_damping = 0;  ///< Rayleigh's β, s, >= 0

  double density = 1000;             ///< kg/m³, > 0; a quarter of a tetrahedron's mass at each of its corners
  std::optional<double> total_mass;  ///< kg, > 0, instead of what follows from the density
  /// All vertices weigh the same, instead of what lies around them: where tetrahedra differ in size, equal springs let
  /// explicit methods take longer steps then.
  bool equal_masses = false;
  Vec3 gravity{0, 0, -9.81};  ///< m/s²

  // Implicit integration.
  double tolerance = 1e-3;  ///< of conjugate gradients: error over what drives the step, 1e-14..0.1
  int iterations = 500;     ///< most of conjugate gradients, >= 1
  int halvings = 8;         ///< how often a step may be halved where these do not converge, 0..20

  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// A constant force on each of the vertices, from a moment to another.
struct VertexForce {
  std::vector<std::uint32_t> vertices;
  Vec3 force;  ///< N, on each of them
  double from = 0, until = std::numeric_limits<double>::infinity();
};

/// Where a handle is at a moment: turned about its centre, then displaced.
struct HandleKey {
  double time = 0;  ///< s
  Vec3 displacement;
  Vec3 turn;  ///< direction of the axis times the angle in radians
};

/// Vertices that are pulled: they go from their rest positions along the keys, at rest before the first and after the
/// last. Between two keys displacements, and vectors of turns, change linearly with time: the centre goes straight, and
/// turns about one and the same axis have a constant speed.
struct PulledHandle {
  std::vector<std::uint32_t> vertices;
  std::vector<HandleKey> keys;  ///< at least one, times increasing
  std::optional<Vec3> center;   ///< of turns; default: the mean of the vertices at rest
  std::optional<double>
      stiffness;  ///< N/m: each vertex hangs on a spring to its target. Absent: it is where the key says
};

/// The half-space below a plane is solid.
struct FloorObstacle {
  Vec3 point;
  Vec3 normal{0, 0, 1};  ///< outward, any length > 0
  double friction = 0;   ///< Coulomb's coefficient, >= 0
};

struct SphereObstacle {
  Vec3 center;
  double radius = 1;    ///< > 0
  double friction = 0;  ///< Coulomb's coefficient, >= 0
};

struct DynamicsScene {
  std::vector<std::uint32_t> fixed;  ///< vertices that stay where they are
  std::vector<VertexForce> forces;
  std::vector<PulledHandle> handles;
  std::vector<FloorObstacle> floors;
  std::vector<SphereObstacle> spheres;

  /// Throws ArgumentError that names the entry (counted from 0) and what is wrong with it, vertices beyond those of a
  /// mesh of `vertices` ones included, and vertices that are fixed or pulled twice.
  void validate(std::size_t vertices) const;
};

}  // namespace sansmesh::inline v1
