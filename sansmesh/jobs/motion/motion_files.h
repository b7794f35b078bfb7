// Files of a motion: its frames as tetrahedra, surfaces and pictures, and an animation.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sansmesh/image.h"
#include "sansmesh/progress.h"
#include "sansmesh/simulate.h"

namespace sansmesh::inline v1 {

struct MotionFiles {
  /// One file per frame: NAME.vtu (with NAME.pvd), NAME.png, or a mesh file; NAME_0000.vtu, …
  std::vector<std::string> outputs = {};
  std::string animation = {};  ///< all pictures in one animated PNG
  std::string energies = {};   ///< all moments as a CSV table
  bool ascii = false;          ///< writes meshes as text

  /// Whether there are pictures.
  bool draws() const;
  /// Data of the motion that these files need.
  KeptMotion kept() const;
  /// Throws FileError if a file cannot be written, ArgumentError if none is named.
  void check() const;
  /// Throws ArgumentError if the frame rate of an animation is out of range, FileError if a file is one of the inputs.
  /// Empty names of inputs are ignored.
  void check(const SimulationPlan& plan, const std::vector<std::string>& inputs) const;
};

struct MotionUse {
  double frame_time = 0;                              ///< time between frames, s
  MotionPictures* pictures = nullptr;                 ///< required if there are pictures
  std::function<Image(const Image&)> part = nullptr;  ///< crops each written picture
  std::function<void()> before_more = nullptr;        ///< called before each frame is written, except the first
};

/// Writes all files and returns their names. If a frame fails, the .pvd lists the frames before it. Throws FileError,
/// Cancelled.
std::vector<std::string> write_motion(const MotionFiles& files, const SimulateResult& made,
                                      const CarriedSurface& surface, const MotionUse& use, Progress& progress);

}  // namespace sansmesh::inline v1
