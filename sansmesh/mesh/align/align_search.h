// Poses of one surface on another, looked for everywhere.
#pragma once

#include <vector>

#include "sansmesh/mesh/align/align_side.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1::detail {

/// Even samples of both sides, as far apart as each other.
struct SearchSamples {
  OrientedPoints moving, fixed;
  double spacing = 0;
  bool signs = true;  ///< the normals of both tell the sides of the surface
};

SearchSamples search_samples(const AlignSide& moving, const AlignSide& fixed);

struct FoundPose {
  Pose pose;
  double score = 0;  ///< mean of the shares of both surfaces that lie on each other, 0..1
};

/// The best ones, best first, no two of which are nearly the same: by rotations in even steps about the middle, and by
/// pairs of places with like features. `scale`: of any size.
std::vector<FoundPose> search_poses(const AlignSide& moving, const AlignSide& fixed, const SearchSamples& samples,
                                    bool scale, Progress& progress);

/// Whether two poses put the samples at about the same places.
bool nearly_same(const Pose& a, const Pose& b, const AlignSide& moving, double angle, double distance);

}  // namespace sansmesh::inline v1::detail
