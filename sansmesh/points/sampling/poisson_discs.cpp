#include "sansmesh/points/sampling/poisson_discs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sansmesh/core/index_in.h"

namespace sansmesh::inline v1 {
namespace {

/// Key of a grid cell from its coordinates, with 21 bits each.
std::uint64_t cell_key(std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr std::uint64_t kMask = (1u << 21) - 1;
  return (static_cast<std::uint64_t>(x) & kMask) | ((static_cast<std::uint64_t>(y) & kMask) << 21) |
         ((static_cast<std::uint64_t>(z) & kMask) << 42);
}

/// Selected points by cell: an open-addressing hash table of cells, each with a linked list of points.
class KeptCells {
 public:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  KeptCells() : slots_(1 << 10) {}

  /// First entry of a cell, or kNone; the others follow by `next`.
  std::uint32_t first(std::uint64_t key) const { return slots_[find(key)].head; }
  std::uint32_t next(std::uint32_t entry) const { return entries_[entry].next; }
  std::uint32_t point(std::uint32_t entry) const { return entries_[entry].point; }

  void add(std::uint64_t key, std::uint32_t point) {
    if (2 * (used_ + 1) > slots_.size()) grow();
    Slot& slot = slots_[find(key)];
    used_ += slot.head == kNone;
    slot.key = key;
    entries_.push_back({point, slot.head});
    slot.head = static_cast<std::uint32_t>(entries_.size() - 1);
  }

 private:
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t head = kNone;
  };
  struct Entry {
    std::uint32_t point, next;
  };

  std::size_t find(std::uint64_t key) const {
    const std::size_t mask = slots_.size() - 1;
    std::uint64_t h = key * 0x9e3779b97f4a7c15u;
    h ^= h >> 32;
    std::size_t at = static_cast<std::size_t>(h) & mask;
    while (slots_[at].head != kNone && slots_[at].key != key) at = (at + 1) & mask;
    return at;
  }

  void grow() {
    std::vector<Slot> old(4 * slots_.size());
    old.swap(slots_);
    for (const Slot& slot : old)
      if (slot.head != kNone) slots_[find(slot.key)] = slot;
  }

  std::vector<Slot> slots_;
  std::vector<Entry> entries_;
  std::size_t used_ = 0;
};

/// Stride that is coprime to n: its multiples visit the numbers below n in scattered order.
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
  KeptCells cells;
  const std::size_t stride = scattered_stride(n);
  const double r2 = radius * radius;
  // Slightly larger than the radius, so that rounding never puts two neighbours two cells apart; and limited, so that
  // cell numbers do not overflow.
  const double edge = radius * (1 + 1e-4);
  const auto cell = [edge](double v) {
    constexpr std::int64_t kFarthest = std::int64_t{1} << 60;
    return index_in<std::int64_t>(std::floor(v / edge), -kFarthest, kFarthest);
  };
  for (std::size_t k = 0, i = 0; k < n; ++k, i = (i + stride) % n) {
    const Vec3& p = points[i];
    const std::int64_t x = cell(p.x), y = cell(p.y), z = cell(p.z);
    const auto free_in = [&](std::int64_t cx, std::int64_t cy, std::int64_t cz) {
      for (std::uint32_t at = cells.first(cell_key(cx, cy, cz)); at != KeptCells::kNone; at = cells.next(at))
        if (squared_norm(points[cells.point(at)] - p) < r2) return false;
      return true;
    };
    bool free = free_in(x, y, z);  // tests the most likely cell first
    for (std::int64_t dx = -1; dx <= 1 && free; ++dx)
      for (std::int64_t dy = -1; dy <= 1 && free; ++dy)
        for (std::int64_t dz = -1; dz <= 1 && free; ++dz)
          if (dx != 0 || dy != 0 || dz != 0) free = free_in(x + dx, y + dy, z + dz);
    if (!free) continue;
    cells.add(cell_key(x, y, z), static_cast<std::uint32_t>(i));
    kept.push_back(static_cast<std::uint32_t>(i));
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

}  // namespace sansmesh::inline v1
