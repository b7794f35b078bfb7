// Agreement of sample polynomials inside cells, which determines their trust.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sansmesh/cell_list.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/volume_values.h"

namespace sansmesh::inline v1 {

/// The square of the smaller of two corrections of one sign, else 0. In cells of higher order their functions are a
/// third opinion: a polynomial that is wrong by itself gains nothing, and does not gain trust for its neighbours.
inline double agreed_square(double a, double b) {
  if (a * b <= 0) return 0;
  const double least = std::min(std::abs(a), std::abs(b));
  return least * least;
}

/// Compares polynomials at the points farthest from the samples: the centres of cells whose corners are samples, or the
/// corners of cells that contain samples. It measures by how much the mean of the polynomials corrects linear
/// interpolation, and the deviation of each polynomial from that mean. At corners on the surface of the volume all
/// polynomials extrapolate, so those of the next samples are included.
class CellAgreement {
 public:
  /// Per sample: means over its points, summed over components.
  struct Share {
    double gain = 0;   ///< squares of the correction
    double doubt = 0;  ///< squares of the deviation of the sample's own polynomial from the mean
  };

  /// Value of a sample's polynomial: (sample, component, point).
  using Polynomials = std::function<double(std::size_t, std::size_t, const Vec3&)>;

  CellAgreement() = default;  ///< without cells, all shares are 0
  /// Empty for lattices. Points with a one-sided polynomial (`split`, one entry per sample) are skipped. `volume` must
  /// outlive the object. Runs in parallel.
  CellAgreement(const SampledVolume& volume, const VolumeValues& values, const Polynomials& p,
                std::span<const std::uint8_t> split);

  Share of(std::size_t sample) const;

 private:
  void ask_middles(const VolumeValues& values, const Polynomials& p, std::span<const std::uint8_t> split);
  void ask_corners(const VolumeValues& values, const Polynomials& p, std::span<const std::uint8_t> split);

  const SampledVolume* volume_ = nullptr;
  Adjacency cells_;            // cells of each sample
  std::vector<Share> shares_;  // per corner of cells, in the order of CellList
};

}  // namespace sansmesh::inline v1
