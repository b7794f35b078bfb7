// How far polynomials about samples agree inside of cells: what tells how much of them to take.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sansmesh/cell_list.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_values.h"

namespace sansmesh::inline v1 {

/// At the places that are farthest from the samples around, the middles of cells whose corners are samples, and the
/// corners of cells that samples are in: by how much the mean of their polynomials corrects linear interpolation, and
/// how far each of them is from that mean. Corners on the surface of the volume, where all is extrapolated, are asked
/// of the polynomials of the next samples, too.
class CellAgreement {
 public:
  /// Of a sample: means over its places, sums over components.
  struct Share {
    double gain = 0;   ///< squares of the correction
    double doubt = 0;  ///< squares of how far the sample's own polynomial is from the mean
  };

  /// What a sample's polynomial is at a place: of a sample, a component, the place.
  using Polynomials = std::function<double(std::size_t, std::size_t, const Vec3&)>;

  CellAgreement() = default;  ///< of no cells: nothing
  /// Of lattices there is nothing. Places where a polynomial is of one side of a step (`split`, one entry a sample) do
  /// not count. `volume` must outlive it. Runs in parallel.
  CellAgreement(const SampledVolume& volume, const VolumeValues& values, const Polynomials& p,
                std::span<const std::uint8_t> split);

  Share of(std::size_t sample) const;

 private:
  void ask_middles(const VolumeValues& values, const Polynomials& p, std::span<const std::uint8_t> split);
  void ask_corners(const VolumeValues& values, const Polynomials& p, std::span<const std::uint8_t> split);

  const SampledVolume* volume_ = nullptr;
  Adjacency cells_;            // of samples
  std::vector<Share> shares_;  // of the corners of cells, numbered as in CellList
};

}  // namespace sansmesh::inline v1
