#include "sansmesh/triangulation/j1a.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <unordered_set>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

// Steps count from 1, as in castelo2006; axis_of(S, i) = π_i.
template <int N>
std::size_t axis_of(const Simplex<N>& s, int step) {
  return s.axis[static_cast<std::size_t>(step - 1)];
}

/// Whether the face at the end of the first `step` steps of a path is refined, given that the faces before are not: a
/// finer block can then only be one that is offset along the last axis. Corners (step = N) are never refined.
template <int N>
bool meets_finer(const BlockView<N>& tree, const Simplex<N>& path, int step) {
  if (step == N) return false;
  BlockCell<N> cell = path.cell;
  const std::size_t last = axis_of(path, step);
  cell[last] += path.sign[last];
  const unsigned subsets = 1u << (step - 1);
  for (unsigned subset = 0; subset < subsets; ++subset) {
    BlockCell<N> other = cell;
    for (int k = 1; k < step; ++k)
      if (subset >> (k - 1) & 1u) other[axis_of(path, k)] += path.sign[axis_of(path, k)];
    if (tree.subdivided(path.level, other)) return true;
  }
  return false;
}

[[noreturn]] void throw_unbalanced() {
  throw ArgumentError("J1A triangulation: the tree of blocks is not 2:1 balanced");
}

template <int N>
std::optional<Simplex<N>> cross_block_face(const BlockView<N>& tree, const Simplex<N>& simplex) {
  const std::size_t a = axis_of(simplex, 1);
  Simplex<N> r = simplex;
  r.sign[a] = static_cast<std::int8_t>(-simplex.sign[a]);
  if (simplex.steps == 1) {  // the block behind the part of the face that t selects
    for (std::size_t k = 0; k < N; ++k) r.cell[k] = 2 * simplex.cell[k] + (simplex.extra[k] > 0 ? 1 : 0);
    r.cell[a] = simplex.sign[a] > 0 ? 2 * (simplex.cell[a] + 1) : 2 * simplex.cell[a] - 1;
    ++r.level;
    r.extra = {};
    r.steps = N;
    if (!tree.is_leaf(r.level, r.cell)) throw_unbalanced();
    return r;
  }
  r.cell[a] += simplex.sign[a];
  if (tree.is_leaf(r.level, r.cell)) return r;
  if (r.level == 0) return std::nullopt;
  // This block is behind one part of a face of a coarser one. None of the edges of that part is refined: its block
  // would touch the coarser one and be finer by two levels.
  BlockCell<N> parent;
  for (std::size_t k = 0; k < N; ++k) {
    parent[k] = r.cell[k] >> 1;
    r.extra[k] = k == a ? 0 : (r.cell[k] & 1) ? 1 : -1;
  }
  --r.level;
  r.cell = parent;
  if (!tree.is_leaf(r.level, r.cell)) return std::nullopt;
  if (simplex.steps != N) throw_unbalanced();
  r.steps = 1;
  return r;
}

/// Extends a path of `step` − 1 full steps in all directions and emits the simplices.
template <int N>
class Enumeration {
 public:
  Enumeration(const BlockView<N>& tree, std::vector<Simplex<N>>& out) : tree_(tree), out_(out) {}

  void full_steps(Simplex<N> path, int step) {
    if (step > N) return out_.push_back(path);
    for (int k = step; k <= N; ++k) {
      Simplex<N> next = path;
      std::swap(next.axis[static_cast<std::size_t>(step - 1)], next.axis[static_cast<std::size_t>(k - 1)]);
      for (const std::int8_t s : {std::int8_t{-1}, std::int8_t{1}}) {
        next.sign[axis_of(next, step)] = s;
        if (!meets_finer(tree_, next, step)) {
          full_steps(next, step + 1);
        } else {
          next.steps = static_cast<std::uint8_t>(step);
          parts(next);
          next.steps = N;
        }
      }
    }
  }

 private:
  // All parts of the refined face, then all half steps inside each.
  void parts(Simplex<N> path) {
    const int h = path.steps;
    for (unsigned bits = 0; bits < 1u << (N - h); ++bits) {
      for (int k = h + 1; k <= N; ++k) path.extra[axis_of(path, k)] = (bits >> (k - h - 1) & 1u) ? 1 : -1;
      half_steps(path, h + 1);
    }
  }
  void half_steps(const Simplex<N>& path, int step) {
    if (step > N) return out_.push_back(path);
    for (int k = step; k <= N; ++k) {
      Simplex<N> next = path;
      std::swap(next.axis[static_cast<std::size_t>(step - 1)], next.axis[static_cast<std::size_t>(k - 1)]);
      for (const std::int8_t s : {std::int8_t{-1}, std::int8_t{1}}) {
        next.sign[axis_of(next, step)] = s;
        half_steps(next, step + 1);
      }
    }
  }

  const BlockView<N>& tree_;
  std::vector<Simplex<N>>& out_;
};

/// View of the tree that caches the neighbourhood of one block, because enumeration queries the same few blocks often.
template <int N>
class Neighbourhood final : public BlockView<N> {
 public:
  Neighbourhood(const BlockView<N>& tree, int level, const BlockCell<N>& cell) : cell_(cell) {
    for (int index = 0; index < kCells; ++index) {
      BlockCell<N> other = cell;
      int nonzero = 0;
      for (int k = 0, rest = index; k < N; ++k, rest /= 3) {
        other[static_cast<std::size_t>(k)] += rest % 3 - 1;
        nonzero += rest % 3 != 1;
      }
      if (nonzero > 0 && nonzero < N) subdivided_[static_cast<std::size_t>(index)] = tree.subdivided(level, other);
    }
  }
  bool is_leaf(int, const BlockCell<N>&) const override { return false; }
  bool subdivided(int, const BlockCell<N>& cell) const override {
    int index = 0;
    for (std::size_t k = N; k-- > 0;) index = 3 * index + (cell[k] - cell_[k] + 1);
    return subdivided_[static_cast<std::size_t>(index)];
  }

 private:
  static constexpr int kCells = N == 2 ? 9 : N == 3 ? 27 : 81;
  BlockCell<N> cell_;
  std::array<bool, kCells> subdivided_{};
};

std::uint64_t mixed(std::uint64_t h, std::uint64_t v) {
  h = (h ^ v) * 0x9e3779b97f4a7c15u;
  return h ^ h >> 29;
}

template <int N>
struct SimplexHash {
  std::size_t operator()(const Simplex<N>& s) const {
    std::uint64_t shape = static_cast<std::uint64_t>(s.level) << 3 | s.steps;
    for (std::size_t k = 0; k < N; ++k)
      shape = shape << 6 | static_cast<std::uint64_t>(s.axis[k] << 4 | (s.sign[k] + 1) << 2 | (s.extra[k] + 1));
    std::uint64_t h = mixed(0, shape);
    for (std::size_t k = 0; k < N; ++k) h = mixed(h, static_cast<std::uint32_t>(s.cell[k]));
    return h;
  }
};

template <int N>
struct VertexHash {
  std::size_t operator()(const LatticeVertex<N>& v) const {
    std::uint64_t h = 0;
    for (std::size_t k = 0; k < N; ++k) h = mixed(h, static_cast<std::uint64_t>(v[k]));
    return h;
  }
};

}  // namespace

template <int N>
std::array<LatticeVertex<N>, N + 1> vertices(const Simplex<N>& simplex) {
  const std::int64_t half = kLatticeEdge >> (simplex.level + 1);
  std::array<LatticeVertex<N>, N + 1> v;
  for (std::size_t k = 0; k < N; ++k) v[0][k] = (2 * std::int64_t{simplex.cell[k]} + 1) * half;
  for (int i = 1; i <= N; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const std::size_t a = axis_of(simplex, i);
    v[at] = v[at - 1];
    v[at][a] += simplex.sign[a] * (i <= simplex.steps ? half : half / 2);
    if (i == simplex.steps)
      for (std::size_t k = 0; k < N; ++k) v[at][k] += simplex.extra[k] * (half / 2);
  }
  return v;
}

template <int N>
int orientation(const Simplex<N>& simplex) {
  int sign = 1;
  for (std::size_t i = 0; i < N; ++i) {
    sign *= simplex.sign[i];
    for (std::size_t k = 0; k < i; ++k)
      if (simplex.axis[k] > simplex.axis[i]) sign = -sign;
  }
  return sign;
}

template <int N>
bool is_valid(const BlockView<N>& tree, const Simplex<N>& simplex) {
  if (simplex.level > kDeepestBlockLevel || simplex.steps < 1 || simplex.steps > N) return false;
  unsigned seen = 0;
  for (int i = 1; i <= N; ++i) {
    const std::size_t a = axis_of(simplex, i);
    if (a >= N || (seen >> a & 1u)) return false;
    seen |= 1u << a;
    if (simplex.sign[a] != 1 && simplex.sign[a] != -1) return false;
    if (i <= simplex.steps ? simplex.extra[a] != 0 : simplex.extra[a] != 1 && simplex.extra[a] != -1) return false;
  }
  if (!tree.is_leaf(simplex.level, simplex.cell)) return false;
  for (int i = 1; i < simplex.steps; ++i)
    if (meets_finer(tree, simplex, i)) return false;
  return simplex.steps == N || meets_finer(tree, simplex, simplex.steps);
}

template <int N>
std::vector<Simplex<N>> simplices_of(const BlockView<N>& tree, int level, const BlockCell<N>& cell) {
  if (level < 0 || level > kDeepestBlockLevel || !tree.is_leaf(level, cell))
    throw ArgumentError("J1A triangulation: only leaves of the tree have simplices");
  std::vector<Simplex<N>> result;
  result.reserve(N == 2 ? 16 : N == 3 ? 192 : 384);
  Simplex<N> path;
  path.cell = cell;
  path.level = static_cast<std::uint8_t>(level);
  for (std::size_t k = 0; k < N; ++k) path.axis[k] = static_cast<std::uint8_t>(k);
  const Neighbourhood<N> around(tree, level, cell);
  Enumeration<N>(around, result).full_steps(path, 1);
  return result;
}

template <int N>
std::optional<Simplex<N>> pivot(const BlockView<N>& tree, const Simplex<N>& simplex, int i) {
  if (i < 0 || i > N) throw ArgumentError("J1A triangulation: a simplex has no vertex of that number");
  if (i == 0) return cross_block_face(tree, simplex);

  Simplex<N> r = simplex;
  if (i == N) {  // the end of the path reverses
    const std::size_t a = axis_of(simplex, N);
    r.sign[a] = static_cast<std::int8_t>(-r.sign[a]);
    return r;
  }
  const int h = simplex.steps;
  const std::size_t a = axis_of(simplex, i), b = axis_of(simplex, i + 1);
  if (i == h && simplex.extra[b] != simplex.sign[b]) {
    // v_{h+1} is in the middle of the refined face, between two of its parts: the neighbour passes through the other
    // part.
    r.extra[b] = static_cast<std::int8_t>(-simplex.extra[b]);
    r.sign[b] = static_cast<std::int8_t>(-simplex.sign[b]);
    return r;
  }
  // The other path from v_{i−1} to v_{i+1}: the two steps are exchanged.
  std::swap(r.axis[static_cast<std::size_t>(i - 1)], r.axis[static_cast<std::size_t>(i)]);
  if (i == h) {
    // v_{h+1} is on the rim of the refined face, in a refined face of lower dimension. On the path over b either the
    // face of step h is refined too, or the first refined face is that of step h + 1.
    r.extra[b] = 0;
    if (meets_finer(tree, r, i)) {
      r.extra[a] = simplex.sign[a];
    } else {
      r.steps = static_cast<std::uint8_t>(h + 1);
    }
  } else if (i + 1 == h && meets_finer(tree, r, i)) {
    // The converse: nothing is refined up to step h − 1 on this path, but on the path over b.
    r.extra[a] = simplex.sign[a];
    r.steps = static_cast<std::uint8_t>(i);
  }
  return r;
}

template <int N>
std::optional<Simplex<N>> locate(const BlockView<N>& tree, const std::array<double, N>& point) {
  BlockCell<N> root{};
  for (std::size_t k = 0; k < N; ++k) {
    // Also false for NaN.
    if (!(std::abs(point[k]) < static_cast<double>(std::numeric_limits<std::int32_t>::max()))) return std::nullopt;
    root[k] = static_cast<std::int32_t>(std::floor(point[k]));
  }
  // A point on a face of a block of level 0 also belongs to the previous block.
  Simplex<N> s;
  bool found = false, leaf = false;
  for (unsigned subset = 0; subset < 1u << N && !found; ++subset) {
    s.cell = root;
    bool possible = true;
    for (std::size_t k = 0; k < N; ++k)
      if (subset >> k & 1u) {
        possible = possible && static_cast<double>(root[k]) == point[k];
        --s.cell[k];
      }
    if (!possible) continue;
    leaf = tree.is_leaf(0, s.cell);
    found = leaf || tree.subdivided(0, s.cell);
  }
  if (!found) return std::nullopt;

  // y ranges from −1 to 1 in the block; each halving is exact up to the last digits of a double.
  std::array<double, N> y;
  for (std::size_t k = 0; k < N; ++k) y[k] = 2 * (point[k] - s.cell[k]) - 1;
  while (!leaf) {
    if (s.level >= kDeepestBlockLevel) return std::nullopt;
    for (std::size_t k = 0; k < N; ++k) {
      const int upper = y[k] >= 0 ? 1 : 0;
      s.cell[k] = 2 * s.cell[k] + upper;
      y[k] = 2 * y[k] + (upper ? -1 : 1);
    }
    ++s.level;
    leaf = tree.is_leaf(s.level, s.cell);
    if (!leaf && !tree.subdivided(s.level, s.cell)) return std::nullopt;
  }

  // All simplices share the centre, those of a face share its centre, and so on: each step follows the longest
  // component.
  const auto sort_from = [&](int step) {
    std::stable_sort(s.axis.begin() + (step - 1), s.axis.end(),
                     [&](std::uint8_t i, std::uint8_t k) { return std::abs(y[i]) > std::abs(y[k]); });
    for (int i = step; i <= N; ++i) s.sign[axis_of(s, i)] = std::signbit(y[axis_of(s, i)]) ? -1 : 1;
  };
  for (std::size_t k = 0; k < N; ++k) s.axis[k] = static_cast<std::uint8_t>(k);
  sort_from(1);
  for (int h = 1; h < N; ++h) {
    if (!meets_finer(tree, s, h)) continue;
    // Seen from v_{h−1} the refined face spans ±reach in the remaining axes; the path turns to the part that contains
    // the point.
    const double reach = std::abs(y[axis_of(s, h)]);
    for (int k = h + 1; k <= N; ++k) {
      const std::size_t a = axis_of(s, k);
      s.extra[a] = s.sign[a];
      y[a] -= s.extra[a] * (reach / 2);
    }
    s.steps = static_cast<std::uint8_t>(h);
    sort_from(h + 1);
    break;
  }
  return s;
}

template <int N>
std::vector<Simplex<N>> walk_crossing(const BlockView<N>& tree, std::span<const Simplex<N>> seeds,
                                      const InsideTest<N>& inside) {
  constexpr unsigned kAll = (1u << (N + 1)) - 1;
  std::vector<Simplex<N>> result;
  std::vector<std::uint8_t> masks;  // bit i: v_i is inside
  std::unordered_set<Simplex<N>, SimplexHash<N>> seen;
  std::unordered_map<LatticeVertex<N>, std::uint32_t, VertexHash<N>> number;
  std::vector<LatticeVertex<N>> asked;
  std::vector<std::uint8_t> answers;
  const auto number_of = [&](const LatticeVertex<N>& v) {
    const auto [it, fresh] = number.try_emplace(v, static_cast<std::uint32_t>(number.size()));
    if (fresh) asked.push_back(v);
    return it->second;
  };
  const auto ask = [&] {
    const std::size_t before = answers.size();
    answers.resize(before + asked.size());
    if (!asked.empty()) inside(asked, std::span(answers).subspan(before));
    asked.clear();
  };

  std::vector<std::array<std::uint32_t, N + 1>> corners(seeds.size());
  for (std::size_t n = 0; n < seeds.size(); ++n) {
    const auto v = vertices(seeds[n]);
    for (std::size_t i = 0; i <= N; ++i) corners[n][i] = number_of(v[i]);
  }
  ask();
  for (std::size_t n = 0; n < seeds.size(); ++n) {
    unsigned mask = 0;
    for (std::size_t i = 0; i <= N; ++i) mask |= static_cast<unsigned>(answers[corners[n][i]] != 0) << i;
    if (mask == 0 || mask == kAll || !seen.insert(seeds[n]).second) continue;
    result.push_back(seeds[n]);
    masks.push_back(static_cast<std::uint8_t>(mask));
  }

  // Processes one front at a time. A pivot replaces one vertex, so a front queries at most one vertex per simplex.
  struct NewVertex {
    std::size_t simplex;
    int corner;
    std::uint32_t number;
  };
  std::vector<NewVertex> fresh;
  for (std::size_t begin = 0; begin < result.size();) {
    const std::size_t end = result.size();
    fresh.clear();
    for (std::size_t n = begin; n < end; ++n)
      for (int i = 0; i <= N; ++i) {
        const unsigned face = kAll & ~(1u << i);
        const unsigned on_face = masks[n] & face;
        if (on_face == 0 || on_face == face) continue;
        const std::optional<Simplex<N>> other = pivot(tree, result[n], i);
        if (!other || !seen.insert(*other).second) continue;
        fresh.push_back({result.size(), i, number_of(vertices(*other)[static_cast<std::size_t>(i)])});
        result.push_back(*other);
        masks.push_back(static_cast<std::uint8_t>(on_face));
      }
    ask();
    for (const NewVertex& v : fresh)
      if (answers[v.number]) masks[v.simplex] = static_cast<std::uint8_t>(masks[v.simplex] | 1u << v.corner);
    begin = end;
  }
  return result;
}

#define SANSMESH_INSTANTIATE(N)                                                                       \
  template std::array<LatticeVertex<N>, N + 1> vertices<N>(const Simplex<N>&);                        \
  template int orientation<N>(const Simplex<N>&);                                                     \
  template bool is_valid<N>(const BlockView<N>&, const Simplex<N>&);                                  \
  template std::vector<Simplex<N>> simplices_of<N>(const BlockView<N>&, int, const BlockCell<N>&);    \
  template std::optional<Simplex<N>> pivot<N>(const BlockView<N>&, const Simplex<N>&, int);           \
  template std::optional<Simplex<N>> locate<N>(const BlockView<N>&, const std::array<double, N>&);    \
  template std::vector<Simplex<N>> walk_crossing<N>(const BlockView<N>&, std::span<const Simplex<N>>, \
                                                    const InsideTest<N>&);
SANSMESH_INSTANTIATE(2)
SANSMESH_INSTANTIATE(3)
SANSMESH_INSTANTIATE(4)
#undef SANSMESH_INSTANTIATE

}  // namespace sansmesh::inline v1
