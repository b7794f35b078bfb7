// Samples that would spoil what follows, taken out before it.
#pragma once

#include <cstddef>

#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// How many samples `clean_samples` took out, and why.
struct SampleCleaning {
  std::size_t non_finite = 0;  ///< position or normal not a number
  std::size_t far_away = 0;    ///< beyond the box of nearly all samples by more than twice its size
  std::size_t duplicates = 0;  ///< at the position of another sample
};

/// Removes non-finite samples; the few (0.1 % at each end of an axis at most) that lie so far away that a grid around
/// all of them would not resolve the shape, such as a survey's line of zeros; and, where they are more than a hundredth
/// of all, repeated positions, which would pass for a denser cloud than there is. O(n), the same for any number of
/// threads.
SampleCleaning clean_samples(PointSet& points);

}  // namespace sansmesh::inline v1
