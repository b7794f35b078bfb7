#include "sansmesh/points/poisson_discs.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

namespace sansmesh {
namespace {

/// Cells of a grid around a point are looked up by the hash of their coordinates, each packed in 21 bits.
std::uint64_t cell_key(std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr std::uint64_t kMask = (1u << 21) - 1;
  return (static_cast<std::uint64_t>(x) & kMask) | ((static_cast<std::uint64_t>(y) & kMask) << 21) |
         ((static_cast<std::uint64_t>(z) & kMask) << 42);
}

/// A permutation of the numbers below n that jumps about: multiples of a large stride that shares no divisor with n.
std::size_t scattered_stride(std::size_t n) {
  std::size_t stride = static_cast<std::size_t>(0.6180339887498949 * static_cast<double>(n)) | 1;
  const auto divisor = [](std::size_t a, std::size_t b) {
    while (b != 0) a = std::exchange(b, a % b);
    return a;
  };
  while (divisor(stride, n) != 1) ++stride;
  return stride;
}

}  // namespace

std::vector<std::uint32_t> poisson_discs(std::span<const Vec3> points, double radius) {
  std::vector<std::uint32_t> kept;
  const std::size_t n = points.size();
  if (n == 0) return kept;
  std::unordered_multimap<std::uint64_t, std::uint32_t> cells;
  const std::size_t stride = scattered_stride(n);
  const double r2 = radius * radius;
  // A little larger than the radius, so that rounding never puts two neighbours two cells apart; and no cell so far
  // away that its number would not fit.
  const double edge = radius * (1 + 1e-4);
  const auto cell = [edge](double v) {
    constexpr double kFarthest = 0x1p60;
    return static_cast<std::int64_t>(std::floor(std::fmax(-kFarthest, std::fmin(v / edge, kFarthest))));
  };
  for (std::size_t k = 0, i = 0; k < n; ++k, i = (i + stride) % n) {
    const Vec3& p = points[i];
    const std::int64_t x = cell(p.x), y = cell(p.y), z = cell(p.z);
    bool free = true;
    for (std::int64_t dx = -1; dx <= 1 && free; ++dx)
      for (std::int64_t dy = -1; dy <= 1 && free; ++dy)
        for (std::int64_t dz = -1; dz <= 1 && free; ++dz) {
          const auto [first, last] = cells.equal_range(cell_key(x + dx, y + dy, z + dz));
          for (auto at = first; at != last && free; ++at) free = squared_norm(points[at->second] - p) >= r2;
        }
    if (!free) continue;
    cells.emplace(cell_key(x, y, z), static_cast<std::uint32_t>(i));
    kept.push_back(static_cast<std::uint32_t>(i));
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

}  // namespace sansmesh
