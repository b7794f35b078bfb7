#include "sansmesh/points/cleaning/duplicates.h"

#include <algorithm>
#include <utility>

#include "sansmesh/core/scramble.h"
#include "sansmesh/search/equal_positions.h"

namespace sansmesh::inline v1 {
namespace {

/// Smaller clouds are processed completely.
constexpr std::size_t kFewestSampled = 100000;

/// Sampling rate for larger clouds, and the number of sampled points at a position that makes it crowded.
constexpr std::size_t kSampledOf = 64, kManyAtOnePosition = 8;

double repeated_share(std::vector<std::uint64_t> hashes) {
  if (hashes.empty()) return 0;
  const auto count = static_cast<double>(hashes.size());
  std::sort(hashes.begin(), hashes.end());
  const auto unique = std::unique(hashes.begin(), hashes.end()) - hashes.begin();
  return 1 - static_cast<double>(unique) / count;
}

/// Ascending hashes of positions that many samples share, from one sample per stretch at a pseudo-random index: with
/// regular steps, the rows of a scan would always contribute the same columns.
std::vector<std::uint64_t> crowded_positions(const PointSet& points) {
  std::vector<std::uint64_t> some, crowded;
  for (std::size_t first = 0; first < points.size(); first += kSampledOf) {
    const std::size_t length = std::min(kSampledOf, points.size() - first);
    const Vec3f& p = points.positions[first + scrambled(first) % length];
    if (is_finite(p)) some.push_back(position_hash(p));
  }
  std::sort(some.begin(), some.end());
  for (std::size_t first = 0, last = 0; first < some.size(); first = last) {
    while (last < some.size() && some[last] == some[first]) ++last;
    if (last - first >= kManyAtOnePosition) crowded.push_back(some[first]);
  }
  return crowded;
}

}  // namespace

double duplicate_share(const PointSet& points) {
  const bool whole = points.size() < kFewestSampled;
  const std::uint64_t mask = whole ? 0 : kSampledOf - 1;
  // Selection by position would count a crowded position entirely or not at all.
  const std::vector<std::uint64_t> crowded = whole ? std::vector<std::uint64_t>() : crowded_positions(points);
  std::size_t finite = 0, in_crowds = 0;
  std::vector<std::uint64_t> hashes;
  for (const Vec3f& p : points.positions) {
    if (!is_finite(p)) continue;
    ++finite;
    const std::uint64_t hash = position_hash(p);
    if (std::binary_search(crowded.begin(), crowded.end(), hash))
      ++in_crowds;
    else if ((hash >> 32 & mask) == 0)
      hashes.push_back(hash);
  }
  if (finite == 0) return 0;
  const auto all = static_cast<double>(finite);
  return static_cast<double>(in_crowds - crowded.size()) / all +
         static_cast<double>(finite - in_crowds) / all * repeated_share(std::move(hashes));
}

std::vector<std::uint8_t> find_duplicates(const PointSet& points) {
  const std::vector<std::uint32_t> first = first_equal_positions(points.positions);
  std::vector<std::uint8_t> mask(points.size());
  for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = first[i] != i || !is_finite(points.positions[i]);
  return mask;
}

std::size_t count_unique(const PointSet& points) {
  const std::vector<std::uint8_t> again = find_duplicates(points);
  return static_cast<std::size_t>(std::count(again.begin(), again.end(), 0));
}

std::vector<Vec3f> different_positions(std::span<const Vec3f> positions) {
  const std::vector<std::uint32_t> first = first_equal_positions(positions);
  std::vector<Vec3f> result;
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (first[i] == i && is_finite(positions[i])) result.push_back(positions[i]);
  return result;
}

}  // namespace sansmesh::inline v1
