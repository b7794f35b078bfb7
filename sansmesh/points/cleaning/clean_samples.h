// Removes samples that would spoil later steps.
#pragma once

#include <cstddef>

#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// Numbers of samples removed by `clean_samples`, by reason.
struct SampleCleaning {
  std::size_t non_finite = 0;  ///< position or normal not finite
  std::size_t far_away = 0;    ///< beyond the box of nearly all samples by more than twice its size
  std::size_t duplicates = 0;  ///< at the position of another sample
};

/// Removes non-finite samples and remote samples: at most 0.1 % at each end of an axis, so far away that a grid around
/// all samples would not resolve the shape (for example a survey's line of zeros). If more than a hundredth of the
/// positions are repeated, also removes duplicates, which would imply a denser cloud. O(n), independent of the number
/// of threads.
SampleCleaning clean_samples(PointSet& points);

}  // namespace sansmesh::inline v1
