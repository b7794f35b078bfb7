// A surface from a file, whatever says where it is: triangles, points, a function, or a value in a volume.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "cloud_input.h"
#include "console.h"
#include "sansmesh/data/triangle_mesh.h"
#include "sansmesh/field/placed_field.h"
#include "sansmesh/function/surface_function.h"
#include "sansmesh/measure/signed_distance.h"
#include "volume_input.h"

namespace sansmesh::cli {

/// Errors of the data are thrown as FileError that name the file.
class SurfaceInput {
 public:
  /// Reads the file, or several as one, and of points those of the classes chosen; warnings go to the console.
  SurfaceInput(CloudInput input, Console& console);
  SurfaceInput(const SurfaceInput&) = delete;
  SurfaceInput& operator=(const SurfaceInput&) = delete;

  /// What to call it: the file, or the first and how many others.
  const std::string& file() const { return file_; }
  /// "file" or "files", and "kind".
  Json json() const;
  /// "mesh", "points", "function" or "isosurface".
  const char* kind() const;
  /// The function or isosurface in the input's coordinates; null for meshes and points.
  const ScalarField* field() const { return placed_ ? &*placed_ : nullptr; }
  /// The mesh or the points as read; of a function or isosurface the mesh, made at the first call.
  TriangleMesh& mesh();
  /// Around mesh, points or the samples of a function (its own box if it has none).
  Box3 bounds() const;
  /// What the reader said; empty for functions and isosurfaces.
  const ReadReport& read() const { return read_; }
  /// From now on the mesh must stay as it is.
  std::unique_ptr<SignedDistance> distance();

 private:
  CloudInput input_;
  std::string file_;
  Console& console_;
  ReadReport read_;
  TriangleMesh mesh_;
  std::optional<SurfaceFunction> function_;
  std::optional<NamedIsosurface> isosurface_;
  std::optional<PlacedField> placed_;
  bool made_ = false;
};

}  // namespace sansmesh::cli
