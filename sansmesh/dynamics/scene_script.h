// Scenes of moving tetrahedra as JSON (docs/formats/scene.md).
#pragma once

#include <optional>
#include <string_view>

#include "sansmesh/simulate_options.h"

namespace sansmesh::inline v1 {

/// The words for models and integrators: "springs", "implicit-euler".
std::optional<SoftBodyModel> soft_body_model(std::string_view word);
std::optional<DynamicsIntegrator> dynamics_integrator(std::string_view word);
constexpr double kMostGravity = 1e6;    ///< m/s²
constexpr double kUsualFriction = 0.3;  ///< of obstacles of which nobody says another
/// In the order of the enumerators.
inline constexpr std::string_view kModelWords[] = {"springs", "corotational"};
inline constexpr std::string_view kIntegratorWords[] = {"explicit-euler", "verlet", "velocity-verlet",
                                                        "implicit-euler"};

/// A scene whose lengths are so many times as large.
DynamicsScene scaled(DynamicsScene scene, double factor);

}  // namespace sansmesh::inline v1
