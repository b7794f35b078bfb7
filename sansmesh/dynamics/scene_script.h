// Scenes of elastic bodies as JSON (docs/formats/scene.md).
#pragma once

#include <optional>
#include <string_view>

#include "sansmesh/simulate_options.h"

namespace sansmesh::inline v1 {

/// The model with this name: "springs".
std::optional<SoftBodyModel> soft_body_model(std::string_view word);
constexpr double kMostGravity = 1e6;    ///< m/s²
constexpr double kUsualFriction = 0.3;  ///< default coefficient of obstacles
/// In the order of the enumerators.
inline constexpr std::string_view kModelWords[] = {"springs", "corotational"};

/// A scene with all lengths multiplied by `factor`.
DynamicsScene scaled(DynamicsScene scene, double factor);

}  // namespace sansmesh::inline v1
