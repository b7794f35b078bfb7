// Tetrahedral meshes from volume files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "sansmesh/grid_data.h"
#include "sansmesh/tet_mesh.h"

namespace sansmesh::inline v1 {

struct TetDataset {
  TetMesh mesh;                          ///< all volumes positive, no unused vertex
  std::vector<std::uint64_t> numbers;    ///< numbers of the vertices of `mesh` in the file
  std::vector<std::uint32_t> by_number;  ///< all vertices by ascending number
  std::vector<std::string> notes;        ///< changes to the cells, one line each

  /// The vertex with this number in the file. Throws DataError if it does not exist or no tetrahedron uses it.
  std::uint32_t vertex(std::uint64_t number) const;
};

/// The cells of all blocks as tetrahedra: hexahedra, wedges and pyramids are subdivided, inverted cells turned,
/// duplicate and hidden ones removed; point and cell arrays are kept. Vertices of a single block keep their numbers
/// (GridBlock::point_numbers); vertices of several blocks are numbered consecutively from 0. Throws DataError if there
/// are no cells, a position is not finite, or a tetrahedron has no volume (below 1e-12 of its longest edge's cube).
TetDataset tet_dataset(const GridData& data);

/// Reads a file (read_volume) and converts its cells. Throws FileError.
TetDataset read_tets(const std::string& file);

}  // namespace sansmesh::inline v1
