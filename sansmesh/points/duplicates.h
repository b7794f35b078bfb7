// Samples at the same position.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// Number of different finite positions (-0 equals 0).
std::size_t count_unique(const PointSet& points);

/// About which share of the samples repeats the position of another one: counted over all of a small cloud. Of a large
/// one two counts are added: of positions that very many samples share, which one sample in 64 tells, and of all other
/// samples, for which one position in 64 stands, chosen by the position, so that pairs are not parted.
double duplicate_share(const PointSet& points);

/// The finite positions, each once, in their order.
std::vector<Vec3f> different_positions(std::span<const Vec3f> positions);

/// 1 where the position equals that of a sample of lower index (or is not finite), 0 elsewhere.
std::vector<std::uint8_t> find_duplicates(const PointSet& points);

}  // namespace sansmesh::inline v1
