#include "sansmesh/polygonize/lattice/lattice.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::uint32_t kUnset = ~std::uint32_t{0};
constexpr std::uint64_t kNoBrick = ~std::uint64_t{0};

std::uint64_t scattered(std::uint64_t key) {
  key *= 0x9e3779b97f4a7c15u;
  return key ^ key >> 32;
}

using Point = std::array<int, 3>;

std::uint8_t slot_of(const Point& p) { return static_cast<std::uint8_t>(p[0] + 5 * p[1] + 25 * p[2]); }
Point point_of(int slot) { return {slot % 5, slot / 5 % 5, slot / 25}; }

int determinant(const Point& o, const Point& a, const Point& b, const Point& c) {
  int m[3][3];
  for (int k = 0; k < 3; ++k) {
    const auto i = static_cast<std::size_t>(k);
    m[0][k] = a[i] - o[i], m[1][k] = b[i] - o[i], m[2][k] = c[i] - o[i];
  }
  return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
         m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

Point moved(Point p, int axis, int by) {
  p[static_cast<std::size_t>(axis)] += by;
  return p;
}

bool edge_is_refined(std::uint32_t edges, int axis, const Point& middle) {
  const int b = axis == 0 ? 1 : 0, c = axis == 2 ? 1 : 2;
  const int bit = 4 * axis + (middle[static_cast<std::size_t>(b)] == 4 ? 1 : 0) +
                  (middle[static_cast<std::size_t>(c)] == 4 ? 2 : 0);
  return (edges >> bit & 1u) != 0;
}

BlockPattern make_pattern(const BlockRefinement& r) {
  std::vector<std::array<Point, 4>> tets;
  const Point centre{2, 2, 2};
  const auto add = [&](const Point& face, const Point& edge, const Point& corner) {
    std::array<Point, 4> t{centre, face, edge, corner};
    if (determinant(t[0], t[1], t[2], t[3]) < 0) std::swap(t[2], t[3]);
    tets.push_back(t);
  };
  // The (sub)face around `middle` with half-edge `half`, in the plane normal to `axis`.
  const auto fan = [&](int axis, const Point& middle, int half, bool outer_edges) {
    for (int along = 0; along < 3; ++along) {
      if (along == axis) continue;
      const int across = 3 - axis - along;
      for (const int side : {-half, half}) {
        const Point edge = moved(middle, across, side);
        if (outer_edges && edge_is_refined(r.edges, along, edge)) {
          for (const int part : {-1, 1}) {
            const Point sub = moved(edge, along, part * half / 2);
            add(middle, sub, moved(sub, along, -half / 2));
            add(middle, sub, moved(sub, along, half / 2));
          }
        } else {
          add(middle, edge, moved(edge, along, -half));
          add(middle, edge, moved(edge, along, half));
        }
      }
    }
  };
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const Point middle = moved(centre, axis, side ? 2 : -2);
      if (r.faces >> (2 * axis + side) & 1u) {
        const int b = axis == 0 ? 1 : 0, c = axis == 2 ? 1 : 2;
        for (const int i : {-1, 1})
          for (const int j : {-1, 1}) fan(axis, moved(moved(middle, b, i), c, j), 1, false);
      } else {
        fan(axis, middle, 2, true);
      }
    }

  BlockPattern pattern;
  std::array<std::uint8_t, 125> position{};
  std::array<bool, 125> seen{};
  for (const auto& t : tets) {
    std::array<std::uint8_t, 4> packed{};
    for (std::size_t k = 0; k < 4; ++k) {
      const std::uint8_t s = slot_of(t[k]);
      if (!seen[s]) {
        seen[s] = true;
        position[s] = static_cast<std::uint8_t>(pattern.slots.size());
        pattern.slots.push_back(s);
      }
      packed[k] = position[s];
    }
    pattern.tets.push_back(packed);
  }
  for (std::size_t i = 0; i < pattern.slots.size(); ++i) {
    const Point p = point_of(pattern.slots[i]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (p[axis] == 0) pattern.face[2 * axis].push_back(static_cast<std::uint8_t>(i));
      if (p[axis] == 4) pattern.face[2 * axis + 1].push_back(static_cast<std::uint8_t>(i));
    }
  }
  return pattern;
}

}  // namespace

void LatticeNumbering::grow() {
  const std::vector<Entry> old =
      std::exchange(table_, std::vector<Entry>(std::max<std::size_t>(64, 2 * table_.size())));
  const std::size_t mask = table_.size() - 1;
  for (const Entry& e : old) {
    if (e.key == kNoBrick) continue;
    std::size_t at = scattered(e.key) & mask;
    while (table_[at].key != kNoBrick) at = (at + 1) & mask;
    table_[at] = e;
  }
}

std::uint32_t LatticeNumbering::brick_of(std::uint64_t key) {
  if (2 * bricks_.size() >= table_.size()) grow();
  const std::size_t mask = table_.size() - 1;
  std::size_t at = scattered(key) & mask;
  while (table_[at].key != kNoBrick && table_[at].key != key) at = (at + 1) & mask;
  if (table_[at].key == kNoBrick) {
    table_[at] = {key, static_cast<std::uint32_t>(bricks_.size())};
    bricks_.emplace_back().fill(kUnset);
  }
  return table_[at].brick;
}

std::uint32_t LatticeNumbering::number(const LatticePoint& p) {
  // Coordinates are at most 1 << 17: fields of 19 bits suffice on every scale.
  const int scale = std::countr_zero(p[0] | p[1] | p[2] | (1u << 20)), shift = scale + 2;
  const std::uint64_t key = static_cast<std::uint64_t>(scale) << 57 | static_cast<std::uint64_t>(p[0] >> shift) << 38 |
                            static_cast<std::uint64_t>(p[1] >> shift) << 19 | static_cast<std::uint64_t>(p[2] >> shift);
  if (key != last_key_) {
    last_brick_ = brick_of(key);
    last_key_ = key;
  }
  std::uint32_t& number =
      bricks_[last_brick_][(p[0] >> scale & 3) | (p[1] >> scale & 3) << 2 | (p[2] >> scale & 3) << 4];
  if (number == kUnset) {
    if (points_.size() == kUnset) throw DataError("the blocks of the mesh have too many vertices for 32-bit indices");
    number = static_cast<std::uint32_t>(points_.size());
    points_.push_back(p);
  }
  return number;
}

BlockRefinement refinement_of(const BlockTree& tree, std::uint32_t block) {
  const BlockTree::Block& b = tree[block];
  BlockRefinement r;
  if (b.level == tree.depth()) return r;  // no finer blocks exist
  const auto finer = [&](int dx, int dy, int dz) {
    return tree.subdivided(b.level, std::int64_t{b.cell[0]} + dx, std::int64_t{b.cell[1]} + dy,
                           std::int64_t{b.cell[2]} + dz);
  };
  std::array<int, 3> d{};
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      d = {};
      d[static_cast<std::size_t>(axis)] = side ? 1 : -1;
      if (finer(d[0], d[1], d[2])) r.faces |= 1u << (2 * axis + side);
    }
  for (int axis = 0; axis < 3; ++axis) {
    const int p = axis == 0 ? 1 : 0, q = axis == 2 ? 1 : 2;
    for (int sp = 0; sp < 2; ++sp)
      for (int sq = 0; sq < 2; ++sq) {
        d = {};
        d[static_cast<std::size_t>(p)] = sp ? 1 : -1;
        d[static_cast<std::size_t>(q)] = sq ? 1 : -1;
        if ((r.faces >> (2 * p + sp) & 1u) || (r.faces >> (2 * q + sq) & 1u) || finer(d[0], d[1], d[2]))
          r.edges |= 1u << (4 * axis + sp + 2 * sq);
      }
  }
  return r;
}

const BlockPattern& PatternTable::pattern(const BlockRefinement& r) {
  const std::uint32_t key = r.faces | r.edges << 6;
  if (patterns_.empty()) patterns_.resize(std::size_t{1} << 18);
  std::unique_ptr<BlockPattern>& pattern = patterns_[key];
  if (!pattern) pattern = std::make_unique<BlockPattern>(make_pattern(r));
  return *pattern;
}

}  // namespace sansmesh::inline v1
