// Consolidation: an even, denoised set of points in place of a cloud.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

struct LopOptions {
  /// Points of the result, at least 1. Default: half as many as there are samples. With more than there are samples the
  /// result lies on the surface, but is no more even than random samples.
  std::optional<std::size_t> points = {};
  /// Radius h of the neighbourhoods (length, > 0); the weights are exp(−16 r²/h²) within it. Default: from the spacing,
  /// that of the result, and the noise.
  std::optional<double> radius = {};
  /// Repulsion between the points, in [0, 0.5): the larger, the more even the result.
  double repulsion = 0.45;
  /// Steps, 1..1000; fewer where the points come to rest.
  int iterations = 25;
  /// Take out the density of the cloud, so that the result is even where the samples are not (Huang et al. 2009).
  bool weighted = true;
  /// Give the result normals: estimated from the new points, with the signs of those of the nearest samples. Without
  /// normals in the cloud there are none.
  bool normals = true;
  /// Where the points start.
  std::uint64_t seed = 1;

  /// All but the number of points, the normals and the seed.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// The locally optimal projection (METHODS §2.1: Lipman et al. 2007; weighted as by Huang et al. 2009). Points that
/// start on samples spread evenly over the area move to weighted *medians* of the samples around them, so that outliers
/// do not attract them, and away from each other. Needs neither normals nor a parameterisation. The origin is that of
/// the cloud; there are no colours or faces. Points without any sample in reach do not move; outliers start none.
/// Beyond the sources: points repel each other along the surface only. Not-finite samples are ignored. The same for any
/// number of threads. Throws ArgumentError for bad options, DataError for a cloud without finite samples.
PointSet consolidate(const PointSet& points, const LopOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
