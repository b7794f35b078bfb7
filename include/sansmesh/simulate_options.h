// Options, scenes and reports of elastic bodies of tetrahedra. SI units; the mesh's unit of length is taken as a metre.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/error.h"
#include "sansmesh/report.h"
#include "sansmesh/tet_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

// ---- Bodies ------------------------------------------------------------------------------------------------------

/// Elastic model of a body.
enum class SoftBodyModel : std::uint8_t {
  springs,       ///< every edge is a spring (tejada2008, 6.4.5)
  corotational,  ///< linear elasticity in the rotated frame of each tetrahedron (mueller2004); stiffness in pascals
};

/// Material of a body and its time integration.
struct SANSMESH_API SoftBodyOptions {
  SoftBodyModel model = SoftBodyModel::springs;  ///< elastic model
  /// Name of the time integrator: "implicit-euler" (baraff1998: stable for stiff bodies and long steps),
  /// "explicit-euler", "verlet" (Störmer's method on positions; damping uses the velocity half a step earlier),
  /// "velocity-verlet" (damping uses the velocity of the same moment), or one that a program registers.
  std::string integrator = "implicit-euler";
  double step = 0.01;  ///< h, seconds, > 0

  // Springs.
  double stiffness = 3000;  ///< k_s of every edge, N/m, > 0
  double damping = 1;       ///< k_d: f = −k_d (v_i − v_j) along every edge, N s/m, >= 0

  // Corotational.
  double young = 1e5;            ///< Pa, > 0
  double poisson = 0.3;          ///< 0..0.49
  double mass_damping = 0;       ///< Rayleigh's α, 1/s, >= 0
  double stiffness_damping = 0;  ///< Rayleigh's β, s, >= 0

  double density = 1000;                  ///< kg/m³, > 0; each corner of a tetrahedron carries a quarter of its mass
  std::optional<double> total_mass = {};  ///< kg, > 0; replaces the mass that follows from `density`
  /// All vertices have the same mass instead of that of the surrounding tetrahedra. Where tetrahedra differ in size,
  /// explicit integrators then remain stable with longer steps.
  bool equal_masses = false;
  Vec3 gravity{0, 0, -9.81};  ///< m/s²

  // Implicit integration.
  double tolerance = 1e-3;  ///< of conjugate gradients: residual relative to the right-hand side, 1e-14..0.1
  int iterations = 500;     ///< largest number of conjugate-gradient iterations, >= 1
  int halvings = 8;         ///< how often a step may be halved when conjugate gradients do not converge, 0..20

  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// "springs", "corotational".
SANSMESH_API std::string_view word_of(SoftBodyModel model);

// ---- Scenes ------------------------------------------------------------------------------------------------------

/// A constant force on each of some vertices during an interval of time.
struct VertexForce {
  std::vector<std::uint32_t> vertices;                     ///< vertex indices
  Vec3 force;                                              ///< N, on each vertex
  double from = 0;                                         ///< s
  double until = std::numeric_limits<double>::infinity();  ///< s
};

/// Pose of a handle at a moment: a rotation about its centre followed by a displacement.
struct HandleKey {
  double time = 0;    ///< s
  Vec3 displacement;  ///< length
  Vec3 turn;          ///< rotation vector: axis times angle in radians
};

/// Vertices whose motion is prescribed by keys. They rest before the first key and after the last. Between keys,
/// displacement and rotation vector are interpolated linearly: the centre moves straight, and rotations about a fixed
/// axis have constant speed.
struct PulledHandle {
  std::vector<std::uint32_t> vertices;  ///< vertex indices
  std::vector<HandleKey> keys;          ///< at least one, times increasing
  std::optional<Vec3> center;           ///< centre of rotation; default: the mean of the vertices at rest
  /// N/m: a spring attaches each vertex to its target. Absent: the vertex is at its target.
  std::optional<double> stiffness;
};

/// A solid half-space below a plane.
struct FloorObstacle {
  Vec3 point;            ///< a point of the plane
  Vec3 normal{0, 0, 1};  ///< outward, any length > 0
  double friction = 0;   ///< Coulomb's coefficient, >= 0
};

/// A solid ball.
struct SphereObstacle {
  Vec3 center;          ///< centre of the ball
  double radius = 1;    ///< > 0
  double friction = 0;  ///< Coulomb's coefficient, >= 0
};

/// Constraints, forces and obstacles that act on a body.
struct SANSMESH_API DynamicsScene {
  std::vector<std::uint32_t> fixed;     ///< vertices that do not move
  std::vector<VertexForce> forces;      ///< external forces
  std::vector<PulledHandle> handles;    ///< handles that pull vertices
  std::vector<FloorObstacle> floors;    ///< solid half-spaces
  std::vector<SphereObstacle> spheres;  ///< solid balls

  /// Throws ArgumentError that names the entry (counted from 0) and the fault: among others, indices beyond `vertices`
  /// and vertices that are fixed or pulled twice.
  void validate(std::size_t vertices) const;
};

/// A unit of length as an option: its name, or its length in metres.
struct LengthUnit {
  double metres = 1;  ///< kLeastUnit..kMostUnit
};
SANSMESH_API std::string text_of_option(const LengthUnit& unit);
/// Throws ArgumentError with the word and the allowed values.
SANSMESH_API void option_of_text(std::string_view word, LengthUnit& unit);

/// Access to the vertices of the body while a scene is parsed.
struct SceneVertices {
  const TetMesh* mesh = nullptr;  ///< mesh at rest, in the unit of its file
  /// Maps a vertex number of the body's file to a vertex index. Throws DataError.
  std::function<std::uint32_t(std::uint64_t number)> find;
  /// Reads the numbers in a file that the scene names (.bou). Throws FileError.
  std::function<std::vector<std::uint64_t>(const std::string& file)> list;
};

/// Contents of a scene file; absent entries were not given.
struct SceneScript {
  std::string file = {};                                                  ///< the scene's file
  std::optional<SoftBodyModel> model;                                     ///< elastic model
  std::optional<std::string> integrator;                                  ///< time integrator
  std::optional<double> step, duration, frames_per_second;                ///< s, s, 1/s
  std::optional<double> unit;                                             ///< length of the file's unit in metres
  std::optional<bool> z_up;                                               ///< the z axis points up
  std::optional<double> stiffness, damping;                               ///< of springs
  std::optional<double> young, poisson, mass_damping, stiffness_damping;  ///< of the corotational model
  std::optional<double> density, mass, tolerance;                         ///< as in SoftBodyOptions
  std::optional<int> iterations, halvings;                                ///< as in SoftBodyOptions
  std::optional<Vec3> gravity;                                            ///< m/s²
  std::optional<double> downwards;  ///< alternative to `gravity`: its magnitude along the downward axis
  std::optional<double> friction;   ///< default of obstacles without a coefficient: kUsualFriction
  bool no_floor = false;            ///< "floor": false
  bool floor_below = false;         ///< "floor": true
  DynamicsScene scene;              ///< lengths and positions in the file's unit
};

/// A scene that cannot be simulated, or lacks a required value.
class SANSMESH_API SceneError : public ArgumentError {
 public:
  explicit SceneError(const std::string& message) : ArgumentError(message) {}  ///< one line
};

/// Throws ArgumentError that begins with the location in the scene ("forces 2.on"), and FileError for files that it
/// names. `z_up`: z points up regardless of the scene; floors without a normal use it.
SANSMESH_API SceneScript parse_scene_script(const std::string& text, const SceneVertices& vertices, bool z_up = false);

// ---- Reports -----------------------------------------------------------------------------------------------------

/// Figures of a time step.
struct StepReport {
  double time = 0;      ///< time at its end, s
  double shortest = 0;  ///< shortest substep, s; the whole step unless it was halved
  int parts = 0;        ///< number of substeps: 1 unless it was halved
  int halvings = 0;     ///< how often conjugate gradients did not converge
  int solves = 0;       ///< linear systems solved; exceeds `parts` where contacts began or ended
  int iterations = 0;   ///< conjugate-gradient iterations in total; 0 for explicit integrators
  int contacts = 0;     ///< vertices in contact with obstacles at its end
  int unsettled = 0;    ///< substeps after whose last solve contacts would still change
};

/// Energies in joules; the potential of gravity is relative to the origin.
struct SANSMESH_API BodyEnergies {
  double kinetic = 0, elastic = 0, gravity = 0;                 ///< J
  double total() const { return kinetic + elastic + gravity; }  ///< J

  static const ReportSchema& schema();  ///< one row per reported value
};

}  // namespace sansmesh::inline v1
