// How far polynomials about samples agree inside of cells: what tells how much of them to take.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/data/cell_list.h"
#include "sansmesh/data/sampled_volume.h"
#include "sansmesh/volume/local_polynomials.h"
#include "sansmesh/volume/volume_values.h"

namespace sansmesh {

/// In the middles of cells, the places that are farthest from all of their corners: by how much the mean of the
/// corners' polynomials corrects linear interpolation, and how far each of them is from that mean.
class CellAgreement {
 public:
  /// Of a sample: means over its cells, sums over components.
  struct Share {
    double gain = 0;   ///< squares of the correction
    double doubt = 0;  ///< squares of how far the sample's own polynomial is from the mean
  };

  CellAgreement() = default;  ///< of no cells: nothing
  /// Of lattices, and of samples that are corners of no cell, there is nothing. Cells where a polynomial is of one side
  /// of a step (`split`, one entry a sample) do not count. `volume` must outlive it. Runs in parallel.
  CellAgreement(const SampledVolume& volume, const VolumeValues& values, const LocalPolynomials& p,
                std::span<const std::uint8_t> split);

  Share of(std::size_t sample) const;

 private:
  const SampledVolume* volume_ = nullptr;
  Adjacency cells_;            // of samples
  std::vector<Share> shares_;  // of the corners of cells, numbered as in CellList
};

}  // namespace sansmesh
