// A displacement map that is exact next to cuts, where a lattice would mix the two sides.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "sansmesh/deform/cuts/occluder.h"
#include "sansmesh/deform/maps/displacement_map.h"
#include "sansmesh/progress.h"
#include "sansmesh/space_map.h"

namespace sansmesh::inline v1 {

/// Uses the lattice, except in cells that a cut crosses and in their neighbours, where it evaluates the map itself. The
/// faces of gaps are therefore exact and the two sides of a cut are not mixed, at the price of the few points near cuts
/// (adaptive sampling: tejada2008, 6.4.3). This includes cuts narrower than a cell. Outside the lattice's box the
/// values are those of the lattice.
class CutMap final : public SpaceMap {
 public:
  /// `exact` with these cuts, on a lattice as in displacement_map(), which also names the stage of `progress`.
  CutMap(std::shared_ptr<const SpaceMap> exact, std::vector<std::shared_ptr<const Occluder>> cuts, const Box3& box,
         const std::array<std::size_t, 3>& sizes, Progress& progress);

  void map(std::span<const Vec3> x, const MappedPoints& wanted) const override;
  bool has_gaps() const override { return lattice_.has_gaps(); }
  /// Bounds over the cells that a box touches and their neighbours; rigorous only away from cuts.
  void images(std::span<const Box3> boxes, std::span<Box3> found) const override;

  const DisplacementMap& lattice() const { return lattice_; }
  /// Share of the cells in which the map itself is evaluated.
  double exact_share() const;

 private:
  std::size_t cell_of(const Vec3& x) const;

  std::shared_ptr<const SpaceMap> exact_;
  DisplacementMap lattice_;
  std::vector<std::uint8_t> beside_cut_;  // per cell
};

}  // namespace sansmesh::inline v1
