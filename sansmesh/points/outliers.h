// Samples that belong to no surface.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

struct OutlierOptions {
  /// A sample is isolated if it is this many times farther from its neighbours than they are from theirs, or than is
  /// typical of the cloud where its neighbours do not look like a surface, > 1.
  double isolation = 4;
  /// Detached clusters of fewer samples than this are outliers; 0 keeps all.
  std::size_t min_cluster = 12;
  /// A sample is off the surface if it is this many standard deviations of those around it from the plane through
  /// them, > 1, and farther than they are from each other; unless `min_cluster` of them are beside it.
  double height = 4;
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// 1 for outliers, 0 for samples to keep. Distances are judged against the spacing around each sample, so samples in
/// sparse regions stay, and where coordinates come in steps, two of these are no distance; a cloud smaller than
/// `min_cluster` is kept whole. Non-finite positions are outliers.
std::vector<std::uint8_t> find_outliers(const PointSet& points, const OutlierOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
