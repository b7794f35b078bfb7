// Samples of quantities in a volume, whatever grid they come from: what every reconstruction starts from.
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

/// Samples at all combinations of coordinates on three axes (uniform and rectilinear grids): nothing else needs to be
/// stored. Sample (i, j, k) has the number i + nx (j + ny k).
struct Lattice {
  std::array<std::vector<double>, 3> axes;  ///< strictly increasing, at least 2 each
  std::array<Vec3, 3> directions{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};  ///< orthonormal, may mirror
  Vec3 origin;
  /// Where the volume ends on each axis: at the first and last sample, or half a cell beyond if values belong to cells.
  std::array<double, 3> lower{}, upper{};
  bool uniform = false;  ///< steps along each axis are equal, to rounding

  std::size_t size() const { return axes[0].size() * axes[1].size() * axes[2].size(); }
  /// Coordinates on the axes of a place, and back.
  Vec3 to_axes(const Vec3& x) const {
    const Vec3 d = x - origin;
    return {dot(directions[0], d), dot(directions[1], d), dot(directions[2], d)};
  }
  Vec3 from_axes(const Vec3& a) const {
    return origin + directions[0] * a.x + directions[1] * a.y + directions[2] * a.z;
  }
  std::array<std::size_t, 3> indices(std::size_t sample) const {
    const std::size_t nx = axes[0].size(), ny = axes[1].size();
    return {sample % nx, sample / nx % ny, sample / (nx * ny)};
  }
  Vec3 position(std::size_t sample) const {
    const auto i = indices(sample);
    return from_axes({axes[0][i[0]], axes[1][i[1]], axes[2][i[2]]});
  }
};

/// What was found and mended on the way from a file's blocks to samples.
struct VolumeFacts {
  std::string grid;                    ///< in words: "curvilinear", "AMR, 4 levels", "3 overlapping curvilinear blocks"
  bool unstructured = false;           ///< a single block of cells in no order: it may be a body
  std::size_t blocks = 0, levels = 1;  ///< as the file has them
  std::size_t points = 0, cells = 0;   ///< as the file has them
  std::size_t merged = 0;              ///< points at the place of another one that became one sample
  std::size_t hidden = 0;              ///< blanked, covered by finer levels, ghosts
  std::size_t overlapped = 0;          ///< samples left out since a finer block covers their place
  std::size_t degenerate = 0;          ///< cells without volume or with corners that coincide
  std::size_t inverted = 0;            ///< cells that were inside out and were turned
  std::size_t not_finite = 0;          ///< points left out since a coordinate is not finite
  std::size_t parts = 1;               ///< that are not connected
  double layer = 0;                    ///< thickness given to a grid that has only one layer (length), or 0
  double least_spacing = 0, median_spacing = 0, most_spacing = 0;  ///< of neighbouring samples (length)
  double aspect = 1;  ///< the largest ratio of longest to shortest edge of a cell
};

/// Samples with values, their neighbours, and the region of space that they stand for. Made by assemble_volume.
///
/// Samples at corners of cells (values of points): `corners` is empty, and the cells' corners are samples. Samples in
/// cells (values of cells): `corners` are the places of the cells' corners, and `cell_sample` tells which sample stands
/// for a cell. Lattices have none of these: they are known by their axes. Scattered samples have the cells of their
/// Delaunay tetrahedralisation.
struct SANSMESH_API SampledVolume {
  std::optional<Lattice> lattice;
  std::vector<Vec3> positions;             ///< of the samples; empty for a lattice
  CellList cells;                          ///< that cover the volume: no degenerate ones, none inside out
  std::vector<Vec3> corners;               ///< see above
  std::vector<std::uint32_t> cell_sample;  ///< see above
  /// The star of each sample: those that share an edge with it (of samples in cells: whose cells share a face), across
  /// the borders of blocks and levels too. Ascending; without the sample itself. Empty for a lattice.
  Adjacency stars;
  std::vector<std::uint32_t> part;   ///< of each sample: number of the connected part; empty if there is only one
  std::vector<std::uint16_t> block;  ///< that a sample comes from, as the file numbers them; empty if there is one
  std::vector<std::uint8_t> level;   ///< of refinement of each sample; empty if there is one
  AttributeTable attributes;         ///< a row a sample
  bool in_cells = false;             ///< values belong to cells
  bool scattered = false;
  VolumeFacts facts;

  std::size_t size() const { return lattice ? lattice->size() : positions.size(); }
  Vec3 position(std::size_t sample) const { return lattice ? lattice->position(sample) : positions[sample]; }
  /// Where corner `c` of a cell (an entry of `cells`) lies.
  const Vec3& corner(std::uint32_t c) const { return corners.empty() ? positions[c] : corners[c]; }
  /// The star of a sample; replaces `out`.
  void star(std::size_t sample, std::vector<std::uint32_t>& out) const;
  /// That the samples and their cells lie in.
  Box3 bounds() const;
};

}  // namespace sansmesh::inline v1
