// Everything that sansmesh simulate writes of a motion.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "motion.h"
#include "sansmesh/io/animation.h"
#include "simulate_scene.h"

namespace sansmesh::cli {

/// Inputs of the pictures, opened and checked before anything moves.
struct PicturesToDraw {
  std::optional<MotionPictures> pictures;
  std::optional<Animation> animation;
};

/// Frames as tetrahedra, surfaces and pictures, and the animation; the names of the files. Frames before one that
/// cannot be written are kept, those of tetrahedra with a .pvd of just them.
std::vector<std::string> write_outputs(const SimulateArguments& a, const Motion& motion, const CarriedSurface& surface,
                                       const DynamicsScene& scene, PicturesToDraw& draw, Console& console);

}  // namespace sansmesh::cli
