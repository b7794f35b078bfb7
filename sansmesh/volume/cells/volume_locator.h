// In which cell a point lies: what linear interpolation, tests of inside and outside and neighbourhoods start from.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// A cell and a place in it. Cells of a lattice are numbered as its samples are: cell (i, j, k) has the samples i, i +
/// 1 … of each axis as corners, in VTK's order of hexahedra.
struct VolumePlace {
  std::uint32_t cell = 0;  ///< the cell that holds the point; outside the one that is nearest, as far as known
  bool inside = false;
  std::uint8_t corner_count = 0;
  /// Entries of `cells` of the volume (samples of a lattice): the corners of the cell.
  std::array<std::uint32_t, 8> corners{};
  /// Shape functions of the cell: linear in tetrahedra, trilinear in hexahedra, with VTK's for pyramids and wedges.
  /// They sum to 1; inside all are >= 0 (to rounding), outside they are those of the nearest place of the cell. In the
  /// outer half cells of lattices of samples in cells they go on linearly: some are < 0.
  std::array<double, 8> weights{};
};

/// Derivatives of the shape functions by the position, at a place found for x; zero where the cell is singular there.
void shape_gradients(const SampledVolume& volume, const VolumePlace& place, const Vec3& x,
                     std::span<Vec3, 8> gradients);

/// The mean length of the edges of the cell of a place.
double local_spacing(const SampledVolume& volume, const VolumePlace& place);

/// How far answers go on outside of the volume: from the nearest place of it, `place`, along `out` towards the point,
/// by at most half of the local spacing. Zero where `out` overflows.
Vec3 held_outside(const SampledVolume& volume, const VolumePlace& place, const Vec3& out);

/// Built once, then asked from any thread. `volume` must outlive it.
class VolumeLocator {
 public:
  explicit VolumeLocator(const SampledVolume& volume);
  ~VolumeLocator();
  VolumeLocator(const VolumeLocator&) = delete;
  VolumeLocator& operator=(const VolumeLocator&) = delete;

  /// Where overlapping cells hold a point, the smallest of them counts (of equal ones the first). A point on a common
  /// face belongs to the cell of least number. Points within 1e-9 of the box's diagonal of a cell are inside. Spreads
  /// large batches over threads; neighbouring points in neighbouring slots go fastest.
  void locate(std::span<const Vec3> x, std::span<VolumePlace> places) const;
  /// The same, faster where it is known about where the points lie: `starts` are cells to look for them in first, one
  /// for each, or one for the first of them, and become those where they (of a single one: the last of up to 256) were
  /// found. Any numbers will do; answers do not depend on them.
  void locate(std::span<const Vec3> x, std::span<VolumePlace> places, std::span<std::uint32_t> starts) const;

  const SampledVolume& volume() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sansmesh::inline v1
