// Point location in a volume, the basis of linear interpolation, inside tests and neighbourhoods.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// A cell and a position in it. Lattice cells are numbered like samples: cell (i, j, k) has the samples i, i + 1 … of
/// each axis as corners, in VTK's order of hexahedra.
struct CellLocation {
  std::uint32_t cell = 0;  ///< the containing cell; outside the volume the nearest one, as far as known
  bool inside = false;
  std::uint8_t corner_count = 0;
  /// Indices in the volume's `cells` (for lattices: samples) of the cell's corners.
  std::array<std::uint32_t, 8> corners{};
  /// Shape functions of the cell: linear in tetrahedra, trilinear in hexahedra, VTK's in pyramids and wedges. They sum
  /// to 1; inside all are >= 0 (up to rounding), outside they are those of the cell's nearest point. In the outer half
  /// cells of cell-data lattices they continue linearly: some are < 0.
  std::array<double, 8> weights{};
};

/// Derivatives of the shape functions by position, at the location of x; zero where the cell is singular.
void shape_gradients(const SampledVolume& volume, const CellLocation& location, const Vec3& x,
                     std::span<Vec3, 8> gradients);

/// Mean edge length of a located cell.
double local_spacing(const SampledVolume& volume, const CellLocation& location);

/// Continuation outside the volume: offset from its nearest point, `location`, along `out` towards the query point, at
/// most half of the local spacing. Zero if `out` overflows.
Vec3 held_outside(const SampledVolume& volume, const CellLocation& location, const Vec3& out);

/// Immutable after construction, safe from any thread. `volume` must outlive it.
class VolumeLocator {
 public:
  explicit VolumeLocator(const SampledVolume& volume);
  ~VolumeLocator();
  VolumeLocator(const VolumeLocator&) = delete;
  VolumeLocator& operator=(const VolumeLocator&) = delete;

  /// Where cells overlap at a point, the smallest counts (among equal ones the first). A point on a common face belongs
  /// to the cell of smallest index. Points within 1e-9 of the box's diagonal of a cell are inside. Large batches run in
  /// parallel; spatially ordered points are fastest.
  void locate(std::span<const Vec3> x, std::span<CellLocation> locations) const;
  /// The same, faster with approximate locations: `starts` are the cells to try first, one per point or one for the
  /// first point. They are replaced by the cells found (a single one: by the last of up to 256). Any numbers are valid;
  /// answers do not depend on them.
  void locate(std::span<const Vec3> x, std::span<CellLocation> locations, std::span<std::uint32_t> starts) const;

  const SampledVolume& volume() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sansmesh::inline v1
