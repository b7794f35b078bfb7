// Gradient and spacing at the samples of a volume, told by the samples around: for whoever weighs samples, not places.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

class SampleSlopes {
 public:
  /// `values`: one a sample, finite. Both must outlive the object. On lattices nothing is computed before it is asked
  /// for; elsewhere gradients are fitted to two rings of the stars.
  SampleSlopes(const SampledVolume& volume, std::span<const double> values);

  /// Of the samples at corners of cells or in cells (value per length). On lattices differences across two steps, of
  /// means with weights 1, 2, 1 along the other axes, which take the edge off noise.
  Vec3 gradient(std::size_t sample) const;
  /// Distance to the samples around (length, > 0): on lattices the edge of the cube that a sample stands for, but no
  /// less than 0.6 of the longest step; elsewhere the mean over the star.
  double spacing(std::size_t sample) const;
  /// The same along a unit vector: cells may be flat or long.
  double spacing_along(std::size_t sample, const Vec3& direction) const;
  /// What the sample stands for (length³); elsewhere than on lattices about that.
  double volume(std::size_t sample) const;
  /// Largest difference to a sample of its star.
  double contrast(std::size_t sample) const;

 private:
  const SampledVolume& volume_;
  std::span<const double> values_;
  std::vector<Vec3> gradients_;  ///< in input coordinates; empty for a lattice
  std::vector<float> spacing_;   ///< empty for a lattice
};

/// The largest gradient that a sample has within 2.2 spacings across the level set at each sample: where its own is no
/// smaller, the quantity changes most there. `steep`: norms of the gradients, one a sample; 0 for samples that are less
/// steep than `least`.
std::vector<float> steepest_across(const SampledVolume& volume, const SampleSlopes& slopes,
                                   std::span<const float> steep, double least);

}  // namespace sansmesh::inline v1
