// Gradient and spacing at the samples of a volume, for methods that weight samples.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

class SampleSlopes {
 public:
  /// `values`: one per sample, finite. Both must outlive the object. On lattices gradients are computed on demand;
  /// elsewhere they are fitted to two rings of the stars.
  SampleSlopes(const SampledVolume& volume, std::span<const double> values);

  /// Gradient at a sample (value per length). On lattices: differences across two steps of averages with weights 1, 2,
  /// 1 along the other axes, which reduce noise.
  Vec3 gradient(std::size_t sample) const;
  /// Distance to the neighbouring samples (length, > 0). On lattices: the edge of the cube that a sample represents, at
  /// least 0.6 of the longest step; elsewhere the mean over the star.
  double spacing(std::size_t sample) const;
  /// The same along a unit vector, for flat or long cells.
  double spacing_along(std::size_t sample, const Vec3& direction) const;
  /// Volume that the sample represents (length³); approximate except on lattices.
  double volume(std::size_t sample) const;
  /// Largest difference to a sample of its star.
  double contrast(std::size_t sample) const;

 private:
  const SampledVolume& volume_;
  std::span<const double> values_;
  std::vector<Vec3> gradients_;  ///< in input coordinates; empty for a lattice
  std::vector<float> spacing_;   ///< empty for a lattice
};

/// The largest gradient norm within 2.2 spacings across the level set at each sample. Where the sample's own norm is at
/// least as large, the quantity changes most there. `steep`: norms of the gradients, one per sample; the result is 0
/// for samples below `least`.
std::vector<float> steepest_across(const SampledVolume& volume, const SampleSlopes& slopes,
                                   std::span<const float> steep, double least);

}  // namespace sansmesh::inline v1
