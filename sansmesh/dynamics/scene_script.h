// Scenes of moving tetrahedra as JSON (docs/formats/scene.md).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/dynamics/length_unit.h"
#include "sansmesh/dynamics/soft_body_options.h"
#include "sansmesh/tet_mesh.h"

namespace sansmesh::inline v1 {

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
  std::optional<double> friction;   ///< of obstacles that have none of their own: kUsualFriction
  bool no_floor = false;            ///< "floor": false
  bool floor_below = false;         ///< "floor": true
  DynamicsScene scene;              ///< lengths and positions in the file's unit
};

/// Throws ArgumentError that begins with the place in the scene ("forces 2.on"), FileError for files that it names.
/// `z_up`: that z points up whatever the scene says, of which floors without a normal of their own take it.
SceneScript parse_scene_script(const std::string& text, const SceneVertices& vertices, bool z_up = false);

/// The words for models and integrators: "springs", "implicit-euler".
std::optional<SoftBodyModel> soft_body_model(std::string_view word);
std::optional<DynamicsIntegrator> dynamics_integrator(std::string_view word);
constexpr double kMostGravity = 1e6;    ///< m/s²
constexpr double kUsualFriction = 0.3;  ///< of obstacles of which nobody says another
/// In the order of the enumerators.
inline constexpr std::string_view kModelWords[] = {"springs", "corotational"};
inline constexpr std::string_view kIntegratorWords[] = {"explicit-euler", "verlet", "velocity-verlet",
                                                        "implicit-euler"};
constexpr std::string_view word_of(SoftBodyModel model) { return kModelWords[static_cast<std::size_t>(model)]; }
constexpr std::string_view word_of(DynamicsIntegrator integrator) {
  return kIntegratorWords[static_cast<std::size_t>(integrator)];
}

/// A scene whose lengths are so many times as large.
DynamicsScene scaled(DynamicsScene scene, double factor);

}  // namespace sansmesh::inline v1
