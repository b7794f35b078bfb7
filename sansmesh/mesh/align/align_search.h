// Global search for poses of one surface on another.
#pragma once

#include <vector>

#include "sansmesh/mesh/align/align_side.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1::detail {

/// Even samples of both surfaces with the same spacing.
struct SearchSamples {
  OrientedPoints moving, fixed;
  double spacing = 0;
  bool signs = true;  ///< the normals of both surfaces have known signs
};

SearchSamples search_samples(const AlignSide& moving, const AlignSide& fixed);

struct FoundPose {
  Similarity pose;
  double score = 0;  ///< mean overlap of both surfaces, 0..1
  /// Best first.
  friend bool operator<(const FoundPose& a, const FoundPose& b) { return a.score > b.score; }
};

/// Best distinct poses, best first, from evenly spaced rotations about the centre and from pairs of points with similar
/// features. `scale`: of any size.
std::vector<FoundPose> search_poses(const AlignSide& moving, const AlignSide& fixed, const SearchSamples& samples,
                                    bool scale, Progress& progress);

/// Whether two poses move the samples to nearly the same positions.
bool nearly_same(const Similarity& a, const Similarity& b, const AlignSide& moving, double angle, double distance);

}  // namespace sansmesh::inline v1::detail
