// How samples of a volume lie around each of them: an ellipsoidal norm from the star (METHODS §6.2).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Takes offsets from a sample, lengths, to local coordinates u = M d in which the samples next to it lie in the unit
/// ball, whatever the aspect of the cells: the local norm is ‖u‖. Rows of M; M = diag(1 / extent) E with orthonormal E.
struct StarMetric {
  std::array<Vec3f, 3> rows{};

  Vec3 operator()(const Vec3& d) const {
    return {rows[0].x * d.x + rows[0].y * d.y + rows[0].z * d.z, rows[1].x * d.x + rows[1].y * d.y + rows[1].z * d.z,
            rows[2].x * d.x + rows[2].y * d.y + rows[2].z * d.z};
  }
  /// Mᵀ u: what takes gradients by u to gradients by length.
  Vec3 transposed(const Vec3& u) const { return Vec3(rows[0]) * u.x + Vec3(rows[1]) * u.y + Vec3(rows[2]) * u.z; }
};

/// The metric of neighbours at the given offsets, of which the first `nearest` set the scale (0: all): axes and ratios
/// of extents are those of the offsets' second moments about the sample (about, not around their mean: stars at the
/// boundary are one-sided), and the farthest of those that set the scale has norm 1. For an affine image of a cubic
/// lattice all neighbours along edges have norm 1. Directions in which the star has no extent (a plane, a line) take
/// the least extent that it has in another; without neighbours, or if all coincide, the metric is that of a ball of
/// radius `fallback`, a length > 0.
StarMetric star_metric(std::span<const Vec3> offsets, double fallback, std::size_t nearest = 0);

/// Those of all samples of a volume that is no lattice, from their stars; where these have fewer than six samples
/// (corners of the volume, samples in tetrahedra) from those and the stars of those. Runs in parallel.
std::vector<StarMetric> star_metrics(const SampledVolume& volume);

/// Balls in place of those ellipsoids: the farthest sample of the star has norm 1, whatever the direction. Thesis,
/// figure 6.5, compares the two.
std::vector<StarMetric> spherical_metrics(const SampledVolume& volume);

/// What star_metric is for samples of lattices: offsets along each axis in units of the longer of the two steps there.
StarMetric lattice_metric(const Lattice& lattice, std::size_t sample);

/// The longer of the two steps of an axis at its coordinate i.
double lattice_step(const std::vector<double>& axis, std::size_t i);

}  // namespace sansmesh::inline v1
