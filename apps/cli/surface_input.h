// A surface from a file, whatever says where it is: triangles, points, a function, or a value in a volume.
#pragma once

#include "cloud_input.h"
#include "console.h"
#include "sansmesh/inspect.h"

namespace sansmesh::cli {

struct SurfaceInput {
  AnySurface surface;
  Json json;        ///< "file" or "files", and "kind"
  ReadReport read;  ///< what the reader said; empty for functions and isosurfaces
};

/// Reads the file, or several as one, and of points those of the classes chosen; warnings go to the console. Errors of
/// the data are thrown as FileError that name the file.
SurfaceInput open_surface(const CloudInput& input, Console& console);

}  // namespace sansmesh::cli
