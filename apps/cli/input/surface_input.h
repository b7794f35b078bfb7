// A surface from a file, whatever says where it is: triangles, points, a function, or a value in a volume.
#pragma once

#include <optional>
#include <string>

#include "cli/input/cloud_input.h"
#include "cli/report/console.h"
#include "sansmesh/inspect.h"
#include "sansmesh/solids.h"
#include "sansmesh/volumes.h"

namespace sansmesh::cli {

/// A report on a surface that was read.
struct ReadSurface : ReadFiles {
  std::string kind;                 ///< in a word
  std::optional<VolumeUse> volume;  ///< of isosurfaces
  std::optional<double> value;      ///< of isosurfaces

  static const ReportSchema& schema();
};

struct SurfaceInput {
  AnySurface surface;
  ReadSurface told;
  ReadReport read;  ///< what the reader said; empty for functions and isosurfaces
};

/// Reads the file, or several as one, and of points those of the classes chosen; warnings go to the console. Errors of
/// the data are thrown as FileError that name the file.
SurfaceInput open_surface(const CloudInput& input, Console& console);

/// Reads a solid from an expression (read_solid) and prints its notes. Throws FileError and ArgumentError.
SolidModel open_solid(const std::string& expression, Console& console);

}  // namespace sansmesh::cli
