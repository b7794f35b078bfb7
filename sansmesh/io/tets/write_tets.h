// Writers of tetrahedral meshes and of time series.
#pragma once

#include <span>
#include <string>

#include "sansmesh/tet_mesh.h"

namespace sansmesh::inline v1 {

/// Writes .vtu (VTK XML unstructured grid) with appended, compressed arrays of vertices and tetrahedra. Positions are
/// in single precision unless that loses more than 1e-7 of the extent. Throws FileError, and ArgumentError if arrays
/// have a wrong number of rows or tetrahedra refer to missing vertices.
void write_tets(const std::string& file, const TetMesh& mesh);

/// Throws FileError early if write_tets cannot write a file of that name.
void check_tets_writable(const std::string& file);

/// One file of a time series.
struct TimedFile {
  double time;
  std::string file;  ///< as written in the collection: relative to its folder
};
/// Writes .pvd, the collection that ParaView and read_volume open as a time series. Throws FileError.
void write_collection(const std::string& file, std::span<const TimedFile> files);

}  // namespace sansmesh::inline v1
