// Volumes as stored in files: blocks of points, cells and arrays.
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

/// Representation of a block's points.
enum class GridKind : std::uint8_t {
  lattice,       ///< uniform or rectilinear: `axes`, rotated by `directions`
  curvilinear,   ///< `dims` points in three logical directions: `points`, first index fastest
  unstructured,  ///< `points` and `cells`
  scattered      ///< `points` only
};

/// One block: points, cells and arrays.
struct GridBlock {
  std::string name;                        ///< name in the file, may be empty
  GridKind kind = GridKind::unstructured;  ///< selects the members below

  /// Lattices: coordinates of the points along each axis, strictly increasing, at least one each. Point (i, j, k) has
  /// the number i + nx (j + ny k) and the position origin + axes[0][i] directions[0] + axes[1][j] directions[1] + …
  std::array<std::vector<double>, 3> axes;
  std::array<Vec3, 3> directions{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};  ///< orthonormal, may mirror
  Vec3 origin;  ///< lattices: position of the axis coordinates (0, 0, 0)

  std::array<std::size_t, 3> dims{};         ///< curvilinear: numbers of points, at least 1 each
  std::vector<Vec3> points;                  ///< all kinds except lattices; may be NaN
  std::vector<std::uint64_t> point_numbers;  ///< point numbers in the file; empty: from 0, in order
  CellList cells;  ///< Cells of unstructured blocks. Cells of structured blocks follow from `dims`: cell (i, j, k) has
                   ///< the number i + mx (j + my k) with m = max(1, dims − 1).
  /// For each of `cells` a number: consecutive cells with the same number are pieces of one cell of the file, because
  /// cells of higher order and polyhedra are cut. Their rows in `cell_arrays` are equal, and make one sample. Empty:
  /// all cells are whole.
  std::vector<std::uint32_t> piece_of;
  /// Cells of higher order that `cells` are pieces of: values at points follow their shape functions.
  HigherOrderCells higher;
  /// Flat cells of unstructured blocks without other cells: triangles and quadrilaterals; the fourth corner of
  /// triangles is kNone.
  std::vector<std::array<std::uint32_t, 4>> flat_cells;
  static constexpr std::uint32_t kNone = 0xffffffffu;  ///< missing corner

  AttributeTable point_arrays;  ///< a row per point
  AttributeTable cell_arrays;   ///< a row per cell (per flat cell if there are no others)
  /// Points and cells to ignore: not 0 if blanked (iblank), covered by a finer level, or a ghost copy of another
  /// process. Empty: none.
  std::vector<std::uint8_t> hidden_points, hidden_cells;

  int level = 0;  ///< refinement level (AMR), 0 is the coarsest
};

/// Content of one file, or of several files of one data set.
struct GridData {
  std::vector<GridBlock> blocks;   ///< in file order
  std::vector<double> times;       ///< times of the available steps, if any; NaN if the file of a step is unreadable
  std::optional<double> time;      ///< time of this step, if the file states it
  std::string format;              ///< format as text: "VTK XML unstructured grid"
  std::vector<std::string> notes;  ///< notes for the user: kinds of cells that were subdivided or skipped, …
};

}  // namespace sansmesh::inline v1
