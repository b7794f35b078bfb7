// Surface from a file: triangles, points, a function, or an isosurface of a volume.
#pragma once

#include <optional>
#include <string>

#include "cli/input/cloud_input.h"
#include "cli/report/console.h"
#include "sansmesh/inspect.h"
#include "sansmesh/solids.h"
#include "sansmesh/volumes.h"

namespace sansmesh::cli {

/// Report of a surface that was read.
struct ReadSurface : ReadFiles {
  std::string kind = {};                                        ///< kind of the surface
  std::optional<VolumeUse> volume = {};                         ///< for isosurfaces
  std::optional<double> value = {};                             ///< for isosurfaces
  std::optional<std::string> reference_system = {}, unit = {};  ///< unknown ones are empty

  static const ReportSchema& schema();
};

struct SurfaceInput {
  AnySurface surface;
  ReadSurface report;
  ReadReport read;  ///< notes of the reader; empty for functions and isosurfaces
};

/// Reads one file, or several as one, and keeps points of the selected classes. Warnings are sent to the console.
/// Errors of the data are thrown as FileError with the file name.
SurfaceInput open_surface(const CloudInput& input, Console& console);

/// Reads a solid from an expression (read_solid) and prints its notes. Throws FileError and ArgumentError.
SolidModel open_solid(const std::string& expression, Console& console);

}  // namespace sansmesh::cli
