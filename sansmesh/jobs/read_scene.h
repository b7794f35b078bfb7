// Scene of a simulation from its files.
#pragma once

#include <string>

#include "sansmesh/dataset/tet_dataset.h"
#include "sansmesh/dynamics/scene_script.h"

namespace sansmesh::inline v1 {

/// What the file of a scene says, if one is named, and the vertices in a list (.bou) that stay where they are; both
/// call the vertices as the body's file does. `z_up`: z points up whatever the scene says. Throws FileError.
SceneScript read_scene(const std::string& scene, const std::string& fixed, const TetDataset& body, bool z_up);

}  // namespace sansmesh::inline v1
