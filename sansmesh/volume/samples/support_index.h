// Which supports count where: ellipsoids around samples, found by a tree, that do not reach across gaps of the mesh.
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

  /// What a thread keeps between queries, and their answers.
  struct Memory {
    std::vector<std::uint32_t> supports;  ///< ascending
    std::uint32_t own = 0;                ///< a sample of the cell

    std::vector<std::uint32_t> near;
    SampleSet seen;
  };
  /// Those that may hold points of a cell, and hardly any others; returns the middle of the cell's box. Only supports
  /// count whose sample is at most kRings edges of the mesh away from the samples of the cell.
  Vec3 of_cell(const VolumePlace& cell, Memory& memory) const;
  /// Those that hold a sample, within as many edges of the mesh from it.
  void of_sample(std::uint32_t sample, Memory& memory) const;
  /// Those that hold x, within kRings edges of a place whose star is given. Not for lattices.
  void of_place(const Vec3& x, std::span<const std::uint32_t> star, Memory& memory) const;

  static constexpr int kRings = 4;

 private:
  std::size_t hull_of(const VolumePlace& cell, std::array<Vec3, 8>& hull) const;
  void leave_near(std::span<const Vec3> hull, Memory& memory) const;
  void leave_connected(int rings, Memory& memory) const;

  const SampledVolume* volume_ = nullptr;
  std::span<const StarMetric> metrics_;
  std::span<const float> radii_;
  BoxTree tree_;
};

}  // namespace sansmesh::inline v1
