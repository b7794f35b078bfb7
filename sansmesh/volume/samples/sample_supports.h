// Ellipsoidal supports of samples, adapted to the extent of their neighbourhoods.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/vec.h"
#include "sansmesh/volume/cells/box_tree.h"
#include "sansmesh/volume/samples/star_metric.h"

namespace sansmesh::inline v1::detail {

/// The distance t_i(x) from sample i is that of its star's metric (star_metric.h), so that stretched cells become
/// isotropic, scaled by its farthest neighbour: t_i = 1 at the farthest sample (for cell data also: corner) of the
/// cells around it, limited to three times the median of these distances. Lattices use their steps: t = 1 at the
/// opposite corner of the larger cell on each axis. The support of a sample is t_i < reach.
class SampleSupports {
 public:
  struct Cover {
    std::uint32_t sample;
    double squared;  ///< t²
    Vec3 slope;      ///< half the gradient of t²
  };

  /// reach >= 1. `volume` must outlive it.
  SampleSupports(const SampledVolume& volume, double reach);

  double reach() const { return reach_; }
  /// Replaces `out` by the samples with t_i(x) < reach, in a fixed order. Safe from any thread.
  void covering(const Vec3& x, std::vector<Cover>& out) const;
  /// Coordinates of an offset from sample i with norm t_i, and the transposed map, which converts gradients by these
  /// coordinates to gradients by position.
  Vec3 local(std::uint32_t sample, const Vec3& offset) const;
  Vec3 transposed(std::uint32_t sample, const Vec3& u) const;
  /// t_i² at an offset from sample i, and half its gradient.
  double squared(std::uint32_t sample, const Vec3& offset, Vec3& slope) const;

 private:
  /// 1/A of a lattice's sample along axis k: t² = Σ (x_k − x_ik)² / width.
  double width(std::size_t k, std::size_t i) const;
  void covering_lattice(const Vec3& x, std::vector<Cover>& out) const;

  const SampledVolume& volume_;
  double reach_;
  std::vector<StarMetric> metrics_;
  BoxTree tree_;
};

/// Converts a radius in spacings (distance of neighbours on a lattice) to a reach. A radius of √3 covers the cells
/// around a sample; values up to 1.05 times that count as √3.
double reach_of_radius(double radius);

}  // namespace sansmesh::inline v1::detail
