#include "sansmesh/partition/sample_tree.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/parallel.h"

namespace sansmesh {
namespace {

std::uint64_t spread(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffffULL;
  x = (x | x << 16) & 0x1f0000ff0000ffULL;
  x = (x | x << 8) & 0x100f00f00f00f00fULL;
  x = (x | x << 4) & 0x10c30c30c30c30c3ULL;
  return (x | x << 2) & 0x1249249249249249ULL;
}

std::uint32_t gather(std::uint64_t x) {
  x &= 0x1249249249249249ULL;
  x = (x | x >> 2) & 0x10c30c30c30c30c3ULL;
  x = (x | x >> 4) & 0x100f00f00f00f00fULL;
  x = (x | x >> 8) & 0x1f0000ff0000ffULL;
  x = (x | x >> 16) & 0x1f00000000ffffULL;
  return static_cast<std::uint32_t>((x | x >> 32) & 0x1fffff);
}

struct Item {
  std::uint64_t key;
  std::uint32_t index;
};

// Least significant digit first: stable, so samples of one cell keep the caller's order and the result is unique.
void radix_sort(std::vector<Item>& items, int bits) {
  constexpr int kDigit = 11;
  std::vector<Item> other(items.size());
  for (int shift = 0; shift < bits; shift += kDigit) {
    std::array<std::uint32_t, (1 << kDigit) + 1> start{};
    constexpr std::uint64_t mask = (1 << kDigit) - 1;
    for (const Item& a : items) ++start[(a.key >> shift & mask) + 1];
    for (std::size_t d = 1; d < start.size(); ++d) start[d] += start[d - 1];
    for (const Item& a : items) other[start[a.key >> shift & mask]++] = a;
    items.swap(other);
  }
}

}  // namespace

std::uint64_t morton_code(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return spread(x) | spread(y) << 1 | spread(z) << 2;
}

std::array<std::uint32_t, 3> morton_cell(std::uint64_t code) {
  return {gather(code), gather(code >> 1), gather(code >> 2)};
}

SampleTree::SampleTree(std::span<const Vec3f> positions, std::span<const Vec3f> normals, const Vec3f& lower, float edge,
                       int depth)
    : lower_(lower), edge_(edge) {
  const std::size_t n = positions.size();
  const float scale = static_cast<float>(1u << depth) / edge;
  const float top = static_cast<float>((1u << depth) - 1);
  std::vector<Item> items(n);
  parallel_for(0, n, 16384, [&](std::size_t i) {
    const Vec3f p = (positions[i] - lower) * scale;
    const auto clamp = [&](float v) { return static_cast<std::uint32_t>(std::clamp(v, 0.0f, top)); };
    items[i] = {morton_code(clamp(p.x), clamp(p.y), clamp(p.z)), static_cast<std::uint32_t>(i)};
  });
  radix_sort(items, 3 * depth);

  positions_.resize(n);
  order_.resize(n);
  if (!normals.empty()) normals_.resize(n);
  parallel_for(0, n, 16384, [&](std::size_t i) {
    order_[i] = items[i].index;
    positions_[i] = positions[items[i].index];
    if (!normals.empty()) normals_[i] = normals[items[i].index];
  });

  levels_.resize(static_cast<std::size_t>(depth) + 1);
  Level& finest = levels_.back();
  for (std::size_t i = 0; i < n; ++i) {
    if (i == 0 || items[i].key != items[i - 1].key) {
      finest.code.push_back(items[i].key);
      finest.begin.push_back(static_cast<std::uint32_t>(i));
    }
  }
  finest.begin.push_back(static_cast<std::uint32_t>(n));
  for (int l = depth - 1; l >= 0; --l) {
    const Level& below = level(l + 1);
    Level& here = levels_[static_cast<std::size_t>(l)];
    for (std::size_t c = 0; c < below.size(); ++c) {
      const std::uint64_t code = below.code[c] >> 3;
      if (here.code.empty() || here.code.back() != code) {
        here.code.push_back(code);
        here.begin.push_back(below.begin[c]);
        here.child.push_back(static_cast<std::uint32_t>(c));
      }
    }
    here.begin.push_back(static_cast<std::uint32_t>(n));
    here.child.push_back(static_cast<std::uint32_t>(below.size()));
  }
}

std::int64_t SampleTree::find(int l, std::uint64_t code) const {
  const auto& codes = level(l).code;
  const auto it = std::lower_bound(codes.begin(), codes.end(), code);
  return it != codes.end() && *it == code ? it - codes.begin() : -1;
}

SampleTree::Neighbours SampleTree::root_neighbours() const {
  Neighbours n;
  n.fill(-1);
  n[13] = 0;
  return n;
}

SampleTree::Neighbours SampleTree::child_neighbours(int l, const Neighbours& of_parent, std::uint32_t child) const {
  const Level& here = level(l);
  const Level& below = level(l + 1);
  const unsigned octant = static_cast<unsigned>(below.code[child] & 7);
  Neighbours result;
  std::size_t slot = 0;
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx, ++slot) {
        // Position within the 4×4×4 … block of the parents' children: -1..2 on each axis.
        const int x = static_cast<int>(octant & 1) + dx, y = static_cast<int>(octant >> 1 & 1) + dy,
                  z = static_cast<int>(octant >> 2) + dz;
        const int px = x < 0 ? -1 : x > 1 ? 1 : 0, py = y < 0 ? -1 : y > 1 ? 1 : 0, pz = z < 0 ? -1 : z > 1 ? 1 : 0;
        const std::int32_t p = of_parent[static_cast<std::size_t>(13 + px + 3 * py + 9 * pz)];
        result[slot] = -1;
        if (p < 0) continue;
        const unsigned want =
            static_cast<unsigned>(x & 1) | static_cast<unsigned>(y & 1) << 1 | static_cast<unsigned>(z & 1) << 2;
        const auto at = static_cast<std::size_t>(p);
        for (std::uint32_t c = here.child[at]; c < here.child[at + 1]; ++c) {
          if ((below.code[c] & 7) == want) {
            result[slot] = static_cast<std::int32_t>(c);
            break;
          }
        }
      }
  return result;
}

}  // namespace sansmesh
