// Ellipsoidal norm at a sample of a volume, from its star (tejada2008, 6.3).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Maps an offset from a sample (length) to local coordinates u = M d in which the neighbouring samples are in the unit
/// ball for every aspect ratio of the cells: the local norm is ‖u‖. Rows of M; M = diag(1 / extent) E with
/// orthonormal E.
struct StarMetric {
  std::array<Vec3f, 3> rows{};

  Vec3 operator()(const Vec3& d) const {
    return {rows[0].x * d.x + rows[0].y * d.y + rows[0].z * d.z, rows[1].x * d.x + rows[1].y * d.y + rows[1].z * d.z,
            rows[2].x * d.x + rows[2].y * d.y + rows[2].z * d.z};
  }
  /// Mᵀ u: converts gradients by u to gradients by position.
  Vec3 transposed(const Vec3& u) const { return Vec3(rows[0]) * u.x + Vec3(rows[1]) * u.y + Vec3(rows[2]) * u.z; }
};

/// The metric of neighbours at the given offsets, of which the first `nearest` set the scale (0: all). Axes and ratios
/// of extents follow from the second moments of the offsets about the sample (not about their mean, since stars at the
/// boundary are one-sided); the farthest neighbour that sets the scale has norm 1. For an affine image of a cubic
/// lattice all neighbours along edges have norm 1. Directions without extent (in a plane or a line) get the smallest
/// extent of the others; without distinct neighbours the metric is that of a ball of radius `fallback`, a length > 0.
StarMetric star_metric(std::span<const Vec3> offsets, double fallback, std::size_t nearest = 0);

/// The metrics of all samples of a volume that is no lattice, from their stars; stars with fewer than six samples
/// (corners of the volume, samples in tetrahedra) are extended by the stars of their samples. Runs in parallel.
std::vector<StarMetric> star_metrics(const SampledVolume& volume);

/// Spherical metrics instead of ellipsoidal ones: the farthest sample of the star has norm 1 in every direction
/// (comparison in tejada2008, figure 6.5).
std::vector<StarMetric> spherical_metrics(const SampledVolume& volume);

/// The metric of a sample: its entry of `metrics`; lattices have none, but offsets along each axis in units of the
/// longer of the two adjacent steps.
StarMetric metric_of(const SampledVolume& volume, std::span<const StarMetric> metrics, std::size_t sample);

/// The longer of the two steps of an axis at its coordinate i.
double lattice_step(const std::vector<double>& axis, std::size_t i);

}  // namespace sansmesh::inline v1
