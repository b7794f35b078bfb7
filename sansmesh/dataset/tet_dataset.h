// Tetrahedra out of the files of volumes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "sansmesh/grid_data.h"
#include "sansmesh/tet_mesh.h"

namespace sansmesh::inline v1 {

struct TetDataset {
  TetMesh mesh;                          ///< all volumes positive, no vertex without a tetrahedron
  std::vector<std::uint64_t> numbers;    ///< by which the file calls the vertices of `mesh`
  std::vector<std::uint32_t> by_number;  ///< all vertices by ascending numbers
  std::vector<std::string> notes;        ///< what was turned, cut or left out, one line each

  /// The vertex that the file calls so. Throws DataError where there is none, or no tetrahedron uses it.
  std::uint32_t vertex(std::uint64_t number) const;
};

/// The cells of all blocks as tetrahedra: hexahedra, wedges and pyramids are cut, inverted ones turned, those that are
/// there twice or hidden left out, arrays of points and cells carried along. Of a single block vertices keep their
/// numbers (GridBlock::point_numbers), of several they are counted from 0 through all blocks. Throws DataError where
/// there are none, a position is not finite, or a tetrahedron has no volume (below 1e-12 of its longest edge's cube).
TetDataset tet_dataset(const GridData& data);

/// The same of a file (read_volume). Throws FileError.
TetDataset read_tets(const std::string& file);

}  // namespace sansmesh::inline v1
