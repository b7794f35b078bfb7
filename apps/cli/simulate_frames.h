// The arguments of sansmesh simulate, and the files that it writes of a motion.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "console.h"
#include "option_groups.h"
#include "sansmesh/io/animation.h"
#include "sansmesh/motion_pictures.h"
#include "sansmesh/simulate.h"
#include "volume_colors.h"
#include "volume_input.h"

namespace sansmesh::cli {

struct SimulateArguments {
  std::string tets, forces, fixed, surface, animation, energies, background = "gradient";
  std::vector<std::string> outputs;
  SimulateOptions options;
  bool ascii = false;
  std::string volume_file;
  VolumeInput volume;
  VolumeColors colors;
  PictureArguments picture;

  bool draws() const;
  bool writes_tets() const;
  /// Throws what keeps the outputs from being written, and ArgumentError for what does not go together.
  void check() const;
  /// Inputs are not to be lost: frames get names that nobody typed. Throws FileError.
  void check_overwriting(std::size_t frames) const;
};

/// NAME.vtu becomes NAME_0007.vtu.
std::string motion_frame_name(const std::string& output, std::size_t frame);

/// Opened and checked before anything moves.
struct PicturesToDraw {
  std::optional<MotionPictures> pictures;
  std::optional<Animation> animation;
};

/// Frames as tetrahedra, surfaces and pictures, and the animation; the names of the files. Frames before one that
/// cannot be written are kept, those of tetrahedra with a .pvd of just them.
std::vector<std::string> write_outputs(const SimulateArguments& a, const Motion& motion, const CarriedSurface& surface,
                                       PicturesToDraw& draw, Console& console);

}  // namespace sansmesh::cli
