#include "sansmesh/points/statistics/neighbourhood_sample.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <utility>

#include "sansmesh/box.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/scramble.h"
#include "sansmesh/points/cleaning/duplicates.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kSearchChunk = 65536;
constexpr std::size_t kMostParts = 64;  ///< parts of the cloud; each keeps the nearest samples of every ball
constexpr std::size_t kCoarse = 30000;  ///< samples in the tree that estimates the local density
/// Samples are piled if one position has this many, and this share, of the examined samples.
constexpr std::size_t kLookedAt = 4096, kPile = 32;
constexpr double kPileShare = 0.01;

// One finite sample from each of `count` equal ranges of the file order, at a pseudo-random but fixed index: even over
// scan lines, without aliasing with their period.
std::vector<Vec3f> stratified(std::span<const Vec3f> points, std::size_t count, std::uint64_t seed) {
  const std::size_t n = points.size();
  count = std::min(count, n);
  std::vector<Vec3f> chosen;
  chosen.reserve(count);
  for (std::size_t j = 0; j < count; ++j) {
    const std::size_t first = j * n / count, last = (j + 1) * n / count;
    const std::size_t start = scrambled(seed + j) % (last - first);
    for (std::size_t i = 0; i < last - first; ++i) {
      const Vec3f& p = points[first + (start + i) % (last - first)];
      if (!is_finite(p)) continue;
      chosen.push_back(p);
      break;
    }
  }
  return chosen;
}

// Grid over the cloud that lists the balls touching each cell.
class BallGrid {
 public:
  BallGrid(const Box3f& box, float cell, std::span<const Vec3f> centers, std::span<const float> radii) : box_(box) {
    const Vec3f size = box.size();
    const float largest = std::max({size.x, size.y, size.z});
    float edge = std::max(cell, largest / (kResolution - 1));
    scale_ = edge > 0 ? 1 / edge : 0;  // coincident samples share one cell
    const auto cells_of = [&](std::size_t b) {
      const Vec3f r{radii[b], radii[b], radii[b]};
      return std::pair(cell_of(centers[b] - r), cell_of(centers[b] + r));
    };
    const auto entries = [&] {
      std::size_t count = 0;
      for (std::size_t b = 0; b < centers.size(); ++b) {
        const auto [lower, upper] = cells_of(b);
        std::size_t own = 1;
        for (std::size_t k = 0; k < 3; ++k) own *= static_cast<std::size_t>(upper[k] - lower[k] + 1);
        count += own;
      }
      return count;
    };
    // A few balls much larger than most, for example around coincident samples, do not require cells as small as the
    // others do.
    while (scale_ > 0 && edge < largest && entries() > kMostEntries) edge *= 2, scale_ = 1 / edge;
    for (std::size_t b = 0; b < centers.size(); ++b) {
      const auto [lower, upper] = cells_of(b);
      for (int z = lower[2]; z <= upper[2]; ++z)
        for (int y = lower[1]; y <= upper[1]; ++y)
          for (int x = lower[0]; x <= upper[0]; ++x) entries_.push_back({code({x, y, z}), static_cast<unsigned>(b)});
    }
    parallel_sort(entries_);
    marked_.resize(kResolution * kResolution * kResolution / 64);
    for (const KeyIndex& e : entries_) marked_[e.key / 64] |= std::uint64_t{1} << (e.key % 64);
  }

  template <class Body>
  void for_each_ball(const Vec3f& p, Body&& body) const {
    const std::uint64_t c = code(cell_of(p));
    if (!(marked_[c / 64] >> (c % 64) & 1)) return;
    for (auto e = std::lower_bound(entries_.begin(), entries_.end(), KeyIndex{c, 0});
         e != entries_.end() && e->key == c; ++e)
      body(e->index);
  }

 private:
  static constexpr int kResolution = 256;
  static constexpr std::size_t kMostEntries = 4'000'000;

  std::array<int, 3> cell_of(const Vec3f& p) const {
    const auto clamp = [](float t) { return index_in<int>(t, 0, kResolution - 1); };
    return {clamp((p.x - box_.lower.x) * scale_), clamp((p.y - box_.lower.y) * scale_),
            clamp((p.z - box_.lower.z) * scale_)};
  }
  static std::uint64_t code(const std::array<int, 3>& c) {
    return (static_cast<std::uint64_t>(c[2]) * kResolution + static_cast<std::uint64_t>(c[1])) * kResolution +
           static_cast<std::uint64_t>(c[0]);
  }

  Box3f box_;
  float scale_ = 1;
  std::vector<KeyIndex> entries_;
  std::vector<std::uint64_t> marked_;
};

// Radii that contain about `size` samples according to the coarse tree. Limits radii far above the others: their
// neighbourhoods become smaller, but no ball covers the whole cloud because of a stray sample.
std::vector<float> choose_radii(const KdTree& coarse, double ratio, std::span<const Vec3f> centers, std::size_t size) {
  const double wanted = static_cast<double>(size) / ratio;
  // The centre finds itself if every sample is in the tree.
  const auto k = std::max<std::size_t>(6, whole_part<std::size_t>(wanted * 1.2)) + 2;
  std::vector<float> radii(centers.size());
  parallel_for(0, centers.size(), 16, [&](std::size_t c) {
    std::vector<Neighbour> found(k);
    found.resize(coarse.nearest(centers[c], found));
    // With few coarse samples, the required number is in a smaller ball, by area.
    const float shrink = std::min(1.0f, std::sqrt(static_cast<float>((wanted * 1.3 + 1) / static_cast<double>(k))));
    radii[c] = std::sqrt(found.back().squared_distance) * (found.size() == k ? shrink : 1.0f);
  });
  std::vector<float> sorted = radii;
  const float limit = 6 * median(sorted);
  if (limit > 0)
    for (float& r : radii) r = std::min(r, limit);
  return radii;
}

bool nearer(const Vec3f& a, const Vec3f& b) {
  const float da = squared_norm(a), db = squared_norm(b);
  if (da != db) return da < db;
  if (a.x != b.x) return a.x < b.x;
  return a.y != b.y ? a.y < b.y : a.z < b.z;
}

/// Keeps the `size` nearest distinct offsets of any number added (clusters may put the whole cloud into one ball),
/// independent of their order.
class NearestOffsets {
 public:
  /// `limit`: squared radius of the ball.
  void add(const Vec3f& offset, float limit, std::size_t size) {
    if (!(squared_norm(offset) <= std::min(limit, farthest_))) return;
    if (!offsets_.empty() && offsets_.back() == offset) return;
    offsets_.push_back(offset);
    if (offsets_.size() >= 2 * size + kRoom) shrink(size);
  }
  void add(const NearestOffsets& other, std::size_t size) {
    for (const Vec3f& o : other.offsets_) add(o, farthest_, size);
  }
  /// Offsets in ascending order.
  std::span<const Vec3f> sorted(std::size_t size) {
    shrink(size);
    return offsets_;
  }

 private:
  static constexpr std::size_t kRoom = 16;

  void shrink(std::size_t size) {
    std::sort(offsets_.begin(), offsets_.end(), nearer);
    offsets_.erase(std::unique(offsets_.begin(), offsets_.end()), offsets_.end());
    if (offsets_.size() < size) return;
    offsets_.resize(size);
    farthest_ = squared_norm(offsets_.back());
  }

  std::vector<Vec3f> offsets_;
  float farthest_ = std::numeric_limits<float>::infinity();
};

Neighbourhood as_neighbourhood(const Vec3f& center, std::span<const Vec3f> offsets) {
  Neighbourhood result;
  result.center = center;
  result.offsets.assign(offsets.begin(), offsets.end());
  result.distances.reserve(offsets.size());
  for (const Vec3f& o : offsets) result.distances.push_back(norm(o));
  return result;
}

/// Whether one position represents many samples, as the zeros of a depth camera do; neighbouring samples do not count.
bool lies_in_piles(std::span<const Vec3f> points) {
  std::vector<Vec3f> some = stratified(points, kLookedAt, 3);
  if (some.size() < kPile) return false;
  std::sort(some.begin(), some.end(), nearer);
  const std::size_t many = std::max(kPile, static_cast<std::size_t>(kPileShare * static_cast<double>(some.size())));
  for (std::size_t i = many; i <= some.size(); ++i)
    if (some[i - many] == some[i - 1]) return true;
  return false;
}

}  // namespace

std::vector<Neighbourhood> sample_neighbourhoods(std::span<const Vec3f> points, std::size_t count, std::size_t size) {
  const std::size_t n = points.size();
  const Box3f box = parallel_reduce(
      n, kSearchChunk, Box3f{},
      [&](std::size_t first, std::size_t last) {
        Box3f part;
        for (std::size_t i = first; i < last; ++i)
          if (is_finite(points[i])) part.extend(points[i]);
        return part;
      },
      [](Box3f a, const Box3f& b) {
        a.extend(b);
        return a;
      });
  if (box.empty() || count == 0 || size == 0) return {};
  if (lies_in_piles(points)) return sample_neighbourhoods(different_positions(points), count, size);

  const std::vector<Vec3f> coarse_points = stratified(points, kCoarse, 1);
  const std::vector<Vec3f> centers = stratified(points, count, 0x5a5a5a5a);
  const double ratio = static_cast<double>(n) / static_cast<double>(std::min(n, kCoarse));
  const std::vector<float> radii = choose_radii(KdTree(coarse_points), ratio, centers, size);
  std::vector<float> sorted = radii;
  const BallGrid grid(box, median(sorted), centers, radii);

  const std::size_t chunk = std::max(kSearchChunk, (n + kMostParts - 1) / kMostParts);
  std::vector<std::vector<NearestOffsets>> parts((n + chunk - 1) / chunk);
  parallel_for(0, parts.size(), 1, [&](std::size_t c) {
    parts[c].resize(centers.size());
    for (std::size_t i = c * chunk; i < std::min(n, (c + 1) * chunk); ++i) {
      if (!is_finite(points[i])) continue;
      grid.for_each_ball(points[i], [&](std::uint32_t ball) {
        parts[c][ball].add(points[i] - centers[ball], radii[ball] * radii[ball], size);
      });
    }
  });
  std::vector<Neighbourhood> result(centers.size());
  parallel_for(0, centers.size(), 8, [&](std::size_t c) {
    NearestOffsets all = std::move(parts[0][c]);
    for (std::size_t p = 1; p < parts.size(); ++p) all.add(parts[p][c], size);
    result[c] = as_neighbourhood(centers[c], all.sorted(size));
  });
  return result;
}

}  // namespace sansmesh::inline v1
