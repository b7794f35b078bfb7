// What sansmesh simulate is asked for: its arguments, and the scene that these and a file say together.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "motion.h"
#include "option_groups.h"
#include "sansmesh/dataset/tet_dataset.h"
#include "sansmesh/dynamics/scene_script.h"
#include "sansmesh/io/names.h"

namespace sansmesh::cli {

struct SimulateArguments {
  std::string tets, forces, fixed, surface, animation, energies, background = "gradient";
  std::vector<std::string> outputs;
  SceneScript flags;  ///< as far as they are given: those of the command line
  std::optional<int> frames;
  bool ascii = false;
  CarriedVolume volume;
  std::string volume_file;
  PictureArguments picture;

  bool draws() const {
    return !animation.empty() ||
           std::any_of(outputs.begin(), outputs.end(), [](const std::string& o) { return io::ending(o) == "png"; });
  }
  bool writes_tets() const {
    return std::any_of(outputs.begin(), outputs.end(), [](const std::string& o) { return io::ending(o) == "vtu"; });
  }
};

/// What the scene file and the command line say together; materials of the body's file where neither says another.
SceneScript read_scene(const SimulateArguments& a, const TetDataset& body, std::vector<std::string>& notes);

/// A floor where one is asked for, or nothing else keeps the body from falling for ever.
void add_floor_below(SceneScript& s, const TetMesh& mesh, const SoftBodyOptions& options);

}  // namespace sansmesh::cli
