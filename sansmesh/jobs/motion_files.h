// Files of a motion: its frames as tetrahedra, surfaces and pictures, and an animation.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "sansmesh/image.h"
#include "sansmesh/progress.h"
#include "sansmesh/simulate.h"

namespace sansmesh::inline v1 {

struct MotionFiles {
  /// NAME.vtu (and NAME.pvd), NAME.png, or NAME with an ending of meshes: a file each frame, NAME_0000.vtu, …
  std::vector<std::string> outputs = {};
  std::string animation = {};  ///< all pictures in one PNG
  std::string energies = {};   ///< all moments as a table, CSV
  bool ascii = false;          ///< meshes as text

  /// True if there are pictures.
  bool draws() const;
  /// Positions and velocities that these files need of a motion.
  KeptMotion kept() const;
  /// Throws FileError where one cannot be written, ArgumentError where none is named.
  void check() const;
  /// Throws ArgumentError where an animation cannot be so fast or slow, FileError where a file is one of the inputs,
  /// of which some may be empty.
  void check(const SimulationPlan& plan, const std::vector<std::string>& inputs) const;
};

struct MotionUse {
  double frame_time = 0;                              ///< from frame to frame, s
  MotionPictures* pictures = nullptr;                 ///< needed where there are some
  std::function<Image(const Image&)> part = nullptr;  ///< of each picture that is written
  std::function<void()> before_more = nullptr;        ///< called before each frame but the first is written
};

/// Writes all, and returns the names. Where a frame cannot be written, the .pvd is one of those before it. Throws
/// FileError, Cancelled.
std::vector<std::string> write_motion(const MotionFiles& files, const SimulateResult& made,
                                      const CarriedSurface& surface, const MotionUse& use, Progress& progress);

}  // namespace sansmesh::inline v1
