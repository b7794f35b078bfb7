// Samples of quantities in a volume on any grid: the input of every volume reconstruction.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/attribute_table.h"
#include "sansmesh/box.h"
#include "sansmesh/cell_list.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Samples at all combinations of coordinates on three axes (uniform and rectilinear grids). Sample (i, j, k) has the
/// number i + nx (j + ny k).
struct Lattice {
  std::array<std::vector<double>, 3> axes;  ///< strictly increasing, at least 2 each
  std::array<Vec3, 3> directions{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};  ///< orthonormal, may mirror
  Vec3 origin;  ///< position of the axis coordinates (0, 0, 0)
  /// Bounds of the volume on each axis: the first and last sample, or half a cell beyond them if values belong to
  /// cells.
  std::array<double, 3> lower{}, upper{};
  bool uniform = false;  ///< equal steps along each axis, up to rounding

  /// Number of samples.
  std::size_t size() const { return axes[0].size() * axes[1].size() * axes[2].size(); }
  /// Axis coordinates of a position.
  Vec3 to_axes(const Vec3& x) const {
    const Vec3 d = x - origin;
    return {dot(directions[0], d), dot(directions[1], d), dot(directions[2], d)};
  }
  /// Position of axis coordinates.
  Vec3 from_axes(const Vec3& a) const {
    return origin + directions[0] * a.x + directions[1] * a.y + directions[2] * a.z;
  }
  /// Indices (i, j, k) of a sample.
  std::array<std::size_t, 3> indices(std::size_t sample) const {
    const std::size_t nx = axes[0].size(), ny = axes[1].size();
    return {sample % nx, sample / nx % ny, sample / (nx * ny)};
  }
  /// Position of a sample.
  Vec3 position(std::size_t sample) const {
    const auto i = indices(sample);
    return from_axes({axes[0][i[0]], axes[1][i[1]], axes[2][i[2]]});
  }
};

/// Facts found and repairs made in the conversion of file blocks to samples.
struct VolumeFacts {
  std::string grid;            ///< kind as text: "curvilinear", "AMR, 4 levels", "3 overlapping curvilinear blocks"
  bool unstructured = false;   ///< one unstructured block; may be a solid body
  std::size_t blocks = 0;      ///< number of blocks in the file
  std::size_t levels = 1;      ///< number of refinement levels in the file
  std::size_t points = 0;      ///< number of points in the file
  std::size_t cells = 0;       ///< number of cells in the file
  std::size_t merged = 0;      ///< coincident points merged into one sample
  std::size_t hidden = 0;      ///< blanked, covered by finer levels, or ghosts
  std::size_t overlapped = 0;  ///< samples removed because a finer block covers them
  std::size_t degenerate = 0;  ///< cells without volume or with coincident corners
  std::size_t inverted = 0;    ///< inverted cells that were reoriented
  std::size_t not_finite = 0;  ///< points removed because a coordinate is not finite
  std::size_t parts = 1;       ///< number of connected parts
  double layer = 0;            ///< thickness given to a grid of a single layer (length), or 0
  double least_spacing = 0;    ///< least distance of neighbouring samples (length)
  double median_spacing = 0;   ///< median distance of neighbouring samples (length)
  double most_spacing = 0;     ///< largest distance of neighbouring samples (length)
  double aspect = 1;           ///< largest ratio of longest to shortest edge of a cell
};

/// Samples with values, their neighbours, and the region of space that they cover.
///
/// Point values: samples are the corners of cells, and `corners` is empty. Cell values: `corners` are the positions of
/// the cells' corners, and `cell_sample` is the sample of each cell. Lattices have neither: their axes determine them.
/// Scattered samples have the cells of their Delaunay tetrahedralisation.
struct SANSMESH_API SampledVolume {
  std::optional<Lattice> lattice;          ///< uniform and rectilinear grids: determines all positions
  std::vector<Vec3> positions;             ///< sample positions; empty for a lattice
  CellList cells;                          ///< cells that cover the volume: none degenerate or inverted
  HigherOrderCells higher;                 ///< cells that these are pieces of; nodes are samples. Point values only
  std::vector<Vec3> corners;               ///< see above
  std::vector<std::uint32_t> cell_sample;  ///< see above
  /// Star of each sample: the samples that share an edge with it (for cell values: whose cells share a face), also
  /// across block and level boundaries. Ascending, without the sample itself. Empty for a lattice.
  Adjacency stars;
  std::vector<std::uint32_t> part;   ///< connected part of each sample; empty if there is one
  std::vector<std::uint16_t> block;  ///< block of each sample, as numbered in the file; empty if there is one
  std::vector<std::uint8_t> level;   ///< refinement level of each sample; empty if there is one
  AttributeTable attributes;         ///< a row per sample
  bool in_cells = false;             ///< values belong to cells
  bool scattered = false;            ///< points without a grid; the cells are their Delaunay tetrahedra
  VolumeFacts facts;                 ///< facts found and repairs made in the conversion

  /// Number of samples.
  std::size_t size() const { return lattice ? lattice->size() : positions.size(); }
  /// Position of a sample.
  Vec3 position(std::size_t sample) const { return lattice ? lattice->position(sample) : positions[sample]; }
  /// Position of corner `c` (an entry of `cells`) of a cell.
  const Vec3& corner(std::uint32_t c) const { return corners.empty() ? positions[c] : corners[c]; }
  /// Replaces `out` by the star of a sample.
  void star(std::size_t sample, std::vector<std::uint32_t>& out) const;
  /// Bounding box of the samples and their cells.
  Box3 bounds() const;
};

}  // namespace sansmesh::inline v1
