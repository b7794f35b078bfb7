// Tetrahedra out, and series of files in time.
#pragma once

#include <span>
#include <string>

#include "sansmesh/tet_mesh.h"

namespace sansmesh::inline v1 {

/// Writes .vtu: VTK's XML of an unstructured grid, numbers appended and compressed, with the arrays of vertices and
/// tetrahedra. Positions are in single precision unless that loses more than 1e-7 of the extent. Throws FileError,
/// ArgumentError where arrays have other rows or tetrahedra other corners than there are.
void write_tets(const std::string& file, const TetMesh& mesh);

/// Throws FileError early where write_tets cannot write a file of that name.
void check_tets_writable(const std::string& file);

/// A file of a series.
struct TimedFile {
  double time;
  std::string file;  ///< as the collection will say it: relative to its folder
};
/// Writes .pvd, the collection that ParaView and read_volume open as steps in time. Throws FileError.
void write_collection(const std::string& file, std::span<const TimedFile> files);

}  // namespace sansmesh::inline v1
