// A displacement map that is exact beside cuts: where a lattice would mix what has come apart.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "sansmesh/deform/displacement_map.h"
#include "sansmesh/deform/occluder.h"
#include "sansmesh/progress.h"
#include "sansmesh/space_map.h"

namespace sansmesh::inline v1 {

/// Answers come from the lattice but in its cells that a cut passes and those next to them: there the map itself is
/// asked. So the faces of gaps lie where they are and what belongs to one side of a cut is not mixed with the other's,
/// for the price of the few places near cuts (the adaptive sampling of thesis 6.4.3). Cuts narrower than a cell count,
/// too. Beyond the lattice's box answers are those of the lattice.
class CutMap final : public SpaceMap {
 public:
  /// `exact` with these cuts, on a lattice as displacement_map makes it. The stage of `progress` is that of that.
  CutMap(std::shared_ptr<const SpaceMap> exact, std::vector<std::shared_ptr<const Occluder>> cuts, const Box3& box,
         const std::array<std::size_t, 3>& sizes, Progress& progress);

  void map(std::span<const Vec3> x, const MapAnswers& wanted) const override;
  bool has_gaps() const override { return lattice_.has_gaps(); }
  /// Of the cells that a box touches and their neighbours, which is rigorous only away from cuts.
  void images(std::span<const Box3> boxes, std::span<Box3> found) const override;

  const DisplacementMap& lattice() const { return lattice_; }
  /// Share of the cells in which the map itself is asked.
  double exact_share() const;

 private:
  std::size_t cell_of(const Vec3& x) const;

  std::shared_ptr<const SpaceMap> exact_;
  DisplacementMap lattice_;
  Vec3 spacing_;
  std::vector<std::uint8_t> beside_cut_;  // of each cell
};

}  // namespace sansmesh::inline v1
