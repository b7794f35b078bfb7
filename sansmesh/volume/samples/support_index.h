// Finds the ellipsoidal supports at a point with a tree; supports do not cross gaps of the mesh.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume/cells/box_tree.h"
#include "sansmesh/volume/cells/volume_locator.h"
#include "sansmesh/volume/samples/sample_set.h"
#include "sansmesh/volume/samples/star_metric.h"

namespace sansmesh::inline v1 {

class SupportIndex {
 public:
  SupportIndex() = default;
  /// Supports ‖M_i (x − x_i)‖ < radii[i]. `metrics` are empty for a lattice. All three must outlive it.
  SupportIndex(const SampledVolume& volume, std::span<const StarMetric> metrics, std::span<const float> radii);

  /// Per-thread buffers and results of queries.
  struct Memory {
    std::vector<std::uint32_t> supports;  ///< ascending
    std::uint32_t own = 0;                ///< a sample of the cell

    std::vector<std::uint32_t> near;
    SampleSet seen;
  };
  /// Supports that may contain points of a cell, with few false positives; returns the centre of the cell's box. Only
  /// supports of samples within kRings mesh edges of the cell's samples count.
  Vec3 of_cell(const CellLocation& cell, Memory& memory) const;
  /// Supports that contain a sample, within kRings mesh edges.
  void of_sample(std::uint32_t sample, Memory& memory) const;
  /// Supports that contain x, within kRings edges of a point with the given star. Not for lattices.
  void of_point(const Vec3& x, std::span<const std::uint32_t> star, Memory& memory) const;

  static constexpr int kRings = 4;

 private:
  std::size_t hull_of(const CellLocation& cell, std::array<Vec3, 8>& hull) const;
  void leave_near(std::span<const Vec3> hull, Memory& memory) const;
  void leave_connected(int rings, Memory& memory) const;

  const SampledVolume* volume_ = nullptr;
  std::span<const StarMetric> metrics_;
  std::span<const float> radii_;
  BoxTree tree_;
};

}  // namespace sansmesh::inline v1
