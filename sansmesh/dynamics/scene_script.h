// Scenes of moving tetrahedra as JSON (docs/formats/scene.md).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/data/tet_mesh.h"
#include "sansmesh/dynamics/soft_body_options.h"

namespace sansmesh {

/// How the vertices of the body are called.
struct SceneVertices {
  const TetMesh* mesh = nullptr;  ///< at rest, in the file's unit
  /// The vertex of that number in the file of the body. Throws DataError.
  std::function<std::uint32_t(std::uint64_t number)> find;
  /// The numbers in a file that the scene names (.bou). Throws FileError.
  std::function<std::vector<std::uint64_t>(const std::string& file)> list;
};

/// What a scene says; what it does not say is absent.
struct SceneScript {
  std::optional<SoftBodyModel> model;
  std::optional<DynamicsIntegrator> integrator;
  std::optional<double> step, duration, frames_per_second;  ///< s, s, 1/s
  std::optional<double> unit;                               ///< metres of the file's unit of length
  std::optional<bool> z_up;
  std::optional<double> stiffness, damping;                               ///< of springs
  std::optional<double> young, poisson, mass_damping, stiffness_damping;  ///< of the corotational model
  std::optional<double> density, mass, tolerance;
  std::optional<int> iterations, halvings;
  std::optional<Vec3> gravity;      ///< m/s²
  std::optional<double> downwards;  ///< the same as a number: gravity along the axis that points down
  std::optional<double> friction;   ///< of obstacles that have none of their own
  bool no_floor = false;            ///< "floor": false
  bool floor_below = false;         ///< "floor": true
  DynamicsScene scene;              ///< lengths and positions in the file's unit
};

/// Throws ArgumentError that begins with the place in the scene ("forces 2.on"), FileError for files that it names.
SceneScript parse_scene_script(const std::string& text, const SceneVertices& vertices);

/// The words for models and integrators: "springs", "implicit-euler".
std::optional<SoftBodyModel> soft_body_model(std::string_view word);
std::optional<DynamicsIntegrator> dynamics_integrator(std::string_view word);
/// Metres of "mm", "cm", "dm", "m", "km", "inch", "foot".
std::optional<double> metres_of(std::string_view unit);
const char* word_of(SoftBodyModel model);
const char* word_of(DynamicsIntegrator integrator);

/// A scene whose lengths are so many times as large.
DynamicsScene scaled(DynamicsScene scene, double factor);

/// What is not said, from the body: `mesh` in metres, `script` with all that is known. A body of unknown material is
/// one that bends under its own weight but stands (Young's modulus 25 times density, gravity and size; springs as
/// stiff as a tetrahedron's edge of it), a little damped. The step of explicit methods is half of what is stable; else
/// 0.01 s.
SoftBodyOptions suited_options(const SceneScript& script, const TetMesh& mesh);

}  // namespace sansmesh
