#include "sansmesh/points/duplicates.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/core/scramble.h"

namespace sansmesh::inline v1 {
namespace {

bool lexicographic(const Vec3f& a, const Vec3f& b) {
  if (a.x != b.x) return a.x < b.x;
  return a.y != b.y ? a.y < b.y : a.z < b.z;
}

std::uint64_t hash_of(const Vec3f& p) {
  std::uint64_t hash = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const float c = p[k] + 0.0f;  // −0 becomes 0
    hash = (hash ^ std::bit_cast<std::uint32_t>(c)) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 29;
  }
  return hash;
}

// Sorts the finite samples by a hash of their position: duplicates are adjacent, lowest index first. Callers must
// separate different positions with the same hash.
std::vector<KeyIndex> by_position(std::span<const Vec3f> positions) {
  std::vector<KeyIndex> keys;
  keys.reserve(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (is_finite(positions[i])) keys.push_back({hash_of(positions[i]), static_cast<unsigned>(i)});
  parallel_sort(keys);
  return keys;
}

// Calls duplicate(index) for every finite sample that equals one of lower index; returns the number of the others.
template <class Duplicate>
std::size_t for_each_duplicate(std::span<const Vec3f> positions, const Duplicate& duplicate) {
  const std::vector<KeyIndex> keys = by_position(positions);
  std::size_t unique = 0;
  std::vector<std::uint32_t> run;
  for (std::size_t first = 0, last = 0; first < keys.size(); first = last) {
    while (last < keys.size() && keys[last].key == keys[first].key) ++last;
    run.clear();
    for (std::size_t i = first; i < last; ++i) run.push_back(keys[i].index);
    std::stable_sort(run.begin(), run.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return lexicographic(positions[a], positions[b]); });
    for (std::size_t i = 0; i < run.size(); ++i) {
      if (i > 0 && positions[run[i]] == positions[run[i - 1]])
        duplicate(run[i]);
      else
        ++unique;
    }
  }
  return unique;
}

/// Smaller clouds are processed completely.
constexpr std::size_t kFewestSampled = 100000;

/// Sampling rate for larger clouds, and the number of sampled points at a position that makes it crowded.
constexpr std::size_t kSampledOf = 64, kManyAtOnePlace = 8;

double repeated_share(std::vector<std::uint64_t> hashes) {
  if (hashes.empty()) return 0;
  const auto count = static_cast<double>(hashes.size());
  std::sort(hashes.begin(), hashes.end());
  const auto unique = std::unique(hashes.begin(), hashes.end()) - hashes.begin();
  return 1 - static_cast<double>(unique) / count;
}

/// Ascending hashes of positions that many samples share, from one sample per stretch at a pseudo-random place: with
/// regular steps, the rows of a scan would always contribute the same columns.
std::vector<std::uint64_t> crowded_places(const PointSet& points) {
  std::vector<std::uint64_t> some, crowded;
  for (std::size_t first = 0; first < points.size(); first += kSampledOf) {
    const std::size_t length = std::min(kSampledOf, points.size() - first);
    const Vec3f& p = points.positions[first + scrambled(first) % length];
    if (is_finite(p)) some.push_back(hash_of(p));
  }
  std::sort(some.begin(), some.end());
  for (std::size_t first = 0, last = 0; first < some.size(); first = last) {
    while (last < some.size() && some[last] == some[first]) ++last;
    if (last - first >= kManyAtOnePlace) crowded.push_back(some[first]);
  }
  return crowded;
}

}  // namespace

double duplicate_share(const PointSet& points) {
  const bool whole = points.size() < kFewestSampled;
  const std::uint64_t mask = whole ? 0 : kSampledOf - 1;
  // Selection by position would count a crowded position entirely or not at all.
  const std::vector<std::uint64_t> crowded = whole ? std::vector<std::uint64_t>() : crowded_places(points);
  std::size_t finite = 0, in_crowds = 0;
  std::vector<std::uint64_t> hashes;
  for (const Vec3f& p : points.positions) {
    if (!is_finite(p)) continue;
    ++finite;
    const std::uint64_t hash = hash_of(p);
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

std::size_t count_unique(const PointSet& points) {
  return for_each_duplicate(points.positions, [](std::uint32_t) {});
}

std::vector<Vec3f> different_positions(std::span<const Vec3f> positions) {
  std::vector<std::uint8_t> again(positions.size());
  std::vector<Vec3f> result;
  result.reserve(for_each_duplicate(positions, [&](std::uint32_t i) { again[i] = 1; }));
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (!again[i] && is_finite(positions[i])) result.push_back(positions[i]);
  return result;
}

std::vector<std::uint8_t> find_duplicates(const PointSet& points) {
  std::vector<std::uint8_t> mask(points.size());
  for_each_duplicate(points.positions, [&](std::uint32_t i) { mask[i] = 1; });
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!is_finite(points.positions[i])) mask[i] = 1;
  return mask;
}

}  // namespace sansmesh::inline v1
