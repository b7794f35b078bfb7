// Samples that are not numbers, samples given twice, clouds without volume.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sansmesh/data/point_set.h"

namespace sansmesh {

/// What a cloud spans.
enum class CloudShape { empty, point, line, plane, volume };

/// Extents along the principal axes, relative to the largest one: below 1e-6 (plus what rounding the coordinates to
/// float makes) there is none. Non-finite positions are ignored.
CloudShape classify_shape(const PointSet& points);

std::size_t count_non_finite(const PointSet& points);
/// Number of different finite positions (-0 equals 0).
std::size_t count_unique(const PointSet& points);

/// About which share of the samples repeats the position of another one: counted over one position in 64, chosen by the
/// position, or over all of a small cloud.
double duplicate_share(const PointSet& points);

/// 1 where the position equals that of a sample of lower index (or is not finite), 0 elsewhere.
std::vector<std::uint8_t> find_duplicates(const PointSet& points);

}  // namespace sansmesh
