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
  bool ascii = false;          ///< meshes as text

  /// True if there are pictures.
  bool draws() const;
  bool writes_tets() const;
  /// Throws FileError where one cannot be written.
  void check() const;
  /// Throws ArgumentError where an animation cannot be so fast or slow. `frame_time`: from frame to frame, s.
  void check_rate(double frame_time) const;
  /// Names of all files of so many frames, that of the animation first; it may be empty.
  std::vector<std::string> names(std::size_t frames) const;
};

struct MotionUse {
  double frame_time = 0;                                          ///< from frame to frame, s
  MotionPictures* pictures = nullptr;                             ///< needed where there are some
  std::function<Image(const Image&)> part = nullptr;              ///< of each picture that is written
  std::function<void(std::size_t frame)> before_frame = nullptr;  ///< called before each is written
};

/// Writes all, and returns the names. Where a frame cannot be written, the .pvd is one of those before it. Throws
/// FileError, Cancelled.
std::vector<std::string> write_motion(const MotionFiles& files, const Motion& motion, const CarriedSurface& surface,
                                      const MotionUse& use, Progress& progress);

}  // namespace sansmesh::inline v1
