// Samples at equal positions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/point_set.h"

namespace sansmesh::inline v1 {

/// Number of distinct finite positions (-0 equals 0).
std::size_t count_unique(const PointSet& points);

/// Approximate share of samples that repeat the position of another one; exact for small clouds. For large clouds it
/// adds two counts: positions shared by very many samples, found from one sample in 64; and the other samples,
/// represented by one position in 64, chosen by position so that pairs stay together.
double duplicate_share(const PointSet& points);

/// Distinct finite positions in their order.
std::vector<Vec3f> different_positions(std::span<const Vec3f> positions);

/// 1 for samples with the position of a sample of lower index or a non-finite position, otherwise 0.
std::vector<std::uint8_t> find_duplicates(const PointSet& points);

}  // namespace sansmesh::inline v1
