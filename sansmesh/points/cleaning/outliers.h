// Detects samples off the surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

struct OutlierOptions {
  /// A sample is isolated if its neighbours are this many times farther from it than from their own neighbours, or than
  /// is typical of the cloud where they do not look like a surface; > 1.
  double isolation = 4;
  /// Separate clusters of fewer samples are outliers; 0 keeps all clusters.
  std::size_t min_cluster = 12;
  /// A sample is off the surface if its height over the plane through its neighbours exceeds this many standard
  /// deviations of theirs (> 1) and their spacing, unless `min_cluster` of them are beside it.
  double height = 4;
  /// Throws ArgumentError that names the field.
  void validate() const;
};

/// 1 for outliers, 0 for other samples. Distances are relative to the local spacing, so that samples in sparse regions
/// stay; for quantised coordinates, two steps count as no distance. A cloud smaller than `min_cluster` is kept
/// completely. Non-finite positions are outliers.
std::vector<std::uint8_t> find_outliers(const PointSet& points, const OutlierOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
