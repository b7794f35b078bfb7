// Volumes as files hold them: blocks of points, cells and arrays, before anything is made of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/attribute_table.h"
#include "sansmesh/cell_list.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// How the points of a block are given.
enum class GridKind : std::uint8_t {
  lattice,       ///< uniform or rectilinear: `axes`, turned by `directions`
  curvilinear,   ///< `dims` points in three logical directions, anywhere: `points`, the first index runs fastest
  unstructured,  ///< `points` and `cells`
  scattered      ///< `points` alone
};

/// One block: its points, cells and arrays.
struct GridBlock {
  std::string name;                        ///< of the block in its file, may be empty
  GridKind kind = GridKind::unstructured;  ///< which of the members below are used

  /// lattice: coordinates of the points along each axis, strictly increasing, at least one each; point (i, j, k), the
  /// number i + nx (j + ny k), lies at origin + axes[0][i] directions[0] + axes[1][j] directions[1] + …
  std::array<std::vector<double>, 3> axes;
  std::array<Vec3, 3> directions{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};  ///< orthonormal, may mirror
  Vec3 origin;  ///< lattice: where the coordinates on the axes are 0

  std::array<std::size_t, 3> dims{};         ///< curvilinear: numbers of points, at least 1 each
  std::vector<Vec3> points;                  ///< of all kinds but lattices; may be NaN
  std::vector<std::uint64_t> point_numbers;  ///< by which the file calls them; empty: from 0, in order
  CellList cells;  ///< of unstructured blocks. Those of the structured ones follow from the dims:
                   ///< cell (i, j, k) is number i + mx (j + my k) with m = max(1, dims − 1)
  /// Unstructured blocks: flat cells (triangles and quadrilaterals, the fourth corner kNone for triangles), for files
  /// that have no others.
  std::vector<std::array<std::uint32_t, 4>> flat_cells;
  static constexpr std::uint32_t kNone = 0xffffffffu;  ///< no corner

  AttributeTable point_arrays;  ///< a row for each point
  AttributeTable cell_arrays;   ///< a row for each cell (for each flat cell where there are no others)
  /// Points and cells that do not count: not 0 where blanked (iblank), covered by a finer level, or a copy of another
  /// process's (ghosts). Empty: none.
  std::vector<std::uint8_t> hidden_points, hidden_cells;

  int level = 0;  ///< of refinement (AMR), 0 the coarsest
};

/// The content of one file, or of files that belong together.
struct GridData {
  std::vector<GridBlock> blocks;   ///< in the order of the file
  std::vector<double> times;       ///< of the steps that there are, if any; NaN: its file cannot be read
  std::optional<double> time;      ///< of this step; nothing where the file does not say
  std::string format;              ///< of the file, in words: "VTK XML unstructured grid"
  std::vector<std::string> notes;  ///< what a user should know: cells of kinds that were cut or left out, …
};

}  // namespace sansmesh::inline v1
