// Bodies of tetrahedra that move by forces: what they are made of, how they are integrated, what acts on them. Units:
// SI, lengths in those of the mesh taken as metres.
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

/// What keeps a body in shape.
enum class SoftBodyModel : std::uint8_t {
  springs,       ///< every edge is a spring (METHODS §7.2; thesis 6.4.5)
  corotational,  ///< linear elasticity in each tetrahedron's own rotation: stiffness in pascals
};

/// What a body is made of and how it is integrated.
struct SANSMESH_API SoftBodyOptions {
  SoftBodyModel model = SoftBodyModel::springs;  ///< what keeps it in shape
  /// How it goes from step to step, by name: "implicit-euler" (Baraff and Witkin's [baraff1998]: stable for stiff
  /// bodies and long steps), "explicit-euler", "verlet" (Störmer's, by positions: damping by the velocity of half a
  /// step before), "velocity-verlet" (damping by velocities at the same moment), or what a program adds.
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

  double density = 1000;                  ///< kg/m³, > 0; a quarter of a tetrahedron's mass at each of its corners
  std::optional<double> total_mass = {};  ///< kg, > 0, instead of what follows from the density
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

/// "springs", "corotational".
SANSMESH_API std::string_view word_of(SoftBodyModel model);

// ---- Scenes ------------------------------------------------------------------------------------------------------

/// A constant force on each of the vertices, from a moment to another.
struct VertexForce {
  std::vector<std::uint32_t> vertices;                     ///< by number
  Vec3 force;                                              ///< N, on each of them
  double from = 0;                                         ///< s
  double until = std::numeric_limits<double>::infinity();  ///< s
};

/// Where a handle is at a moment: turned about its centre, then displaced.
struct HandleKey {
  double time = 0;    ///< s
  Vec3 displacement;  ///< length
  Vec3 turn;          ///< direction of the axis times the angle in radians
};

/// Vertices that are pulled: they go from their rest positions along the keys, at rest before the first and after the
/// last. Between two keys displacements, and vectors of turns, change linearly with time: the centre goes straight, and
/// turns about one and the same axis have a constant speed.
struct PulledHandle {
  std::vector<std::uint32_t> vertices;  ///< by number
  std::vector<HandleKey> keys;          ///< at least one, times increasing
  std::optional<Vec3> center;           ///< of turns; default: the mean of the vertices at rest
  std::optional<double>
      stiffness;  ///< N/m: each vertex hangs on a spring to its target. Absent: it is where the key says
};

/// The half-space below a plane is solid.
struct FloorObstacle {
  Vec3 point;            ///< of the plane
  Vec3 normal{0, 0, 1};  ///< outward, any length > 0
  double friction = 0;   ///< Coulomb's coefficient, >= 0
};

/// A ball is solid.
struct SphereObstacle {
  Vec3 center;          ///< of the ball
  double radius = 1;    ///< > 0
  double friction = 0;  ///< Coulomb's coefficient, >= 0
};

/// What holds, pulls and stops a body.
struct SANSMESH_API DynamicsScene {
  std::vector<std::uint32_t> fixed;     ///< vertices that stay where they are
  std::vector<VertexForce> forces;      ///< on vertices
  std::vector<PulledHandle> handles;    ///< that pull vertices
  std::vector<FloorObstacle> floors;    ///< that are not passed
  std::vector<SphereObstacle> spheres;  ///< that are not entered

  /// Throws ArgumentError that names the entry (counted from 0) and what is wrong with it, vertices beyond those of a
  /// mesh of `vertices` ones included, and vertices that are fixed or pulled twice.
  void validate(std::size_t vertices) const;
};

/// A unit as an option: by its name, or its length in metres.
struct LengthUnit {
  double metres = 1;  ///< kLeastUnit..kMostUnit
};
SANSMESH_API std::string text_of_option(const LengthUnit& unit);
/// Throws ArgumentError whose fault has the word and what is allowed.
SANSMESH_API void option_of_text(std::string_view word, LengthUnit& unit);

/// How the vertices of the body are called, while a scene is read.
struct SceneVertices {
  const TetMesh* mesh = nullptr;  ///< at rest, in the file's unit
  /// The vertex of that number in the file of the body. Throws DataError.
  std::function<std::uint32_t(std::uint64_t number)> find;
  /// The numbers in a file that the scene names (.bou). Throws FileError.
  std::function<std::vector<std::uint64_t>(const std::string& file)> list;
};

/// What a scene says; what it does not say is absent.
struct SceneScript {
  std::string file = {};                                                  ///< that it was read from
  std::optional<SoftBodyModel> model;                                     ///< of the body
  std::optional<std::string> integrator;                                  ///< of the motion
  std::optional<double> step, duration, frames_per_second;                ///< s, s, 1/s
  std::optional<double> unit;                                             ///< metres of the file's unit of length
  std::optional<bool> z_up;                                               ///< z points up
  std::optional<double> stiffness, damping;                               ///< of springs
  std::optional<double> young, poisson, mass_damping, stiffness_damping;  ///< of the corotational model
  std::optional<double> density, mass, tolerance;                         ///< as in SoftBodyOptions
  std::optional<int> iterations, halvings;                                ///< as in SoftBodyOptions
  std::optional<Vec3> gravity;                                            ///< m/s²
  std::optional<double> downwards;  ///< the same as a number: gravity along the axis that points down
  std::optional<double> friction;   ///< of obstacles that have none of their own: kUsualFriction
  bool no_floor = false;            ///< "floor": false
  bool floor_below = false;         ///< "floor": true
  DynamicsScene scene;              ///< lengths and positions in the file's unit
};

/// What the scene says, or nobody does, cannot be simulated.
class SANSMESH_API SceneError : public ArgumentError {
 public:
  explicit SceneError(const std::string& message) : ArgumentError(message) {}  ///< one line
};

/// Throws ArgumentError that begins with the place in the scene ("forces 2.on"), FileError for files that it names.
/// `z_up`: that z points up whatever the scene says, of which floors without a normal of their own take it.
SANSMESH_API SceneScript parse_scene_script(const std::string& text, const SceneVertices& vertices, bool z_up = false);

// ---- Reports -----------------------------------------------------------------------------------------------------

/// What a step took.
struct StepReport {
  double time = 0;      ///< s, at its end
  double shortest = 0;  ///< s, of its parts where it was halved, else the step
  int parts = 0;        ///< in how many it was made: 1 where it was not halved
  int halvings = 0;     ///< times that conjugate gradients did not converge
  int solves = 0;       ///< systems, more than parts where contacts were found or lost
  int iterations = 0;   ///< of conjugate gradients, all together; 0 of explicit methods
  int contacts = 0;     ///< vertices that touch obstacles at its end
  int unsettled = 0;    ///< parts after whose last system contacts would still change
};

/// Joules. Of gravity relative to the origin.
struct SANSMESH_API BodyEnergies {
  double kinetic = 0, elastic = 0, gravity = 0;                 ///< J
  double total() const { return kinetic + elastic + gravity; }  ///< J

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

}  // namespace sansmesh::inline v1
