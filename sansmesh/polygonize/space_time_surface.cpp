#include "sansmesh/polygonize/space_time_surface.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <unordered_map>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/triangulation/block_tree_n.h"
#include "sansmesh/triangulation/block_tree_view.h"
#include "sansmesh/triangulation/simplex_cut.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kMostSpaceTimeBlocks = 16'000'000;
/// Lattice coordinates fit 16 bits: quarters of blocks of this level.
constexpr int kDeepestSpaceTime = 13;
/// Values this near to zero, in edges of the smallest blocks, count as so large, and moments this near to one of the
/// lattice, in how long these last, as that: triangles are no thinner, and positions distinct in float.
constexpr double kNearZero = 1e-3, kNearMoment = 2.5e-3;
/// The cube reaches so many of the smallest blocks beyond the field, at least.
constexpr double kAroundField = 2;
/// Places at which a field is asked in one call.
constexpr std::size_t kBatch = std::size_t{1} << 18;

/// Lattice vertex in quarters of the smallest blocks, with t in front: numbers are in the order that all simplices list
/// their vertices in.
using LatticeKey = std::uint64_t;
LatticeKey key_of(const std::array<std::int64_t, 4>& v) {
  LatticeKey key = 0;
  for (std::size_t k = 4; k-- > 0;) key = key << 16 | static_cast<LatticeKey>(v[k]);
  return key;
}
std::int64_t coordinate(LatticeKey key, std::size_t k) { return static_cast<std::int64_t>(key >> (16 * k) & 0xffffu); }

/// The simplices of a block, vertices as places on its 5⁴ grid of quarter edges (x + 5y + 25z + 125t).
struct SpaceTimePattern {
  struct Simplex {
    std::array<std::uint16_t, 5> corner;  ///< of `slots`, increasing
    bool turned;                          ///< negatively oriented
  };
  std::vector<std::uint16_t> slots;  ///< those that are vertices, increasing
  std::vector<Simplex> simplices;
};

SpaceTimePattern make_pattern(const BlockView<4>& tree, int level, const BlockCell<4>& cell) {
  SpaceTimePattern pattern;
  const std::int64_t quarter = kLatticeEdge >> (level + 2);
  std::vector<std::array<std::uint16_t, 5>> all;
  std::vector<bool> turned;
  for (const Simplex<4>& s : simplices_of<4>(tree, level, cell)) {
    const auto v = vertices(s);
    std::array<std::uint16_t, 5> slot{};
    for (std::size_t i = 0; i < 5; ++i) {
      std::int64_t at = 0;
      for (std::size_t k = 4; k-- > 0;) at = 5 * at + (v[i][k] / quarter - 4 * std::int64_t{cell[k]});
      slot[i] = static_cast<std::uint16_t>(at);
    }
    bool odd = false;  // insertion sort, counting exchanges
    for (std::size_t i = 1; i < 5; ++i)
      for (std::size_t k = i; k > 0 && slot[k] < slot[k - 1]; --k) std::swap(slot[k], slot[k - 1]), odd = !odd;
    all.push_back(slot);
    turned.push_back((orientation(s) < 0) != odd);
    pattern.slots.insert(pattern.slots.end(), slot.begin(), slot.end());
  }
  std::sort(pattern.slots.begin(), pattern.slots.end());
  pattern.slots.erase(std::unique(pattern.slots.begin(), pattern.slots.end()), pattern.slots.end());
  for (std::size_t n = 0; n < all.size(); ++n) {
    SpaceTimePattern::Simplex s{{}, turned[n]};
    for (std::size_t i = 0; i < 5; ++i)
      s.corner[i] = static_cast<std::uint16_t>(std::lower_bound(pattern.slots.begin(), pattern.slots.end(), all[n][i]) -
                                               pattern.slots.begin());
    pattern.simplices.push_back(s);
  }
  return pattern;
}

/// Patterns by which of the 64 neighbours that share more than a corner are divided.
class SpaceTimePatterns {
 public:
  const SpaceTimePattern& of(const BlockTreeN<4>& tree, std::uint32_t block) {
    const BlockTreeN<4>::Block& b = tree[block];
    std::uint64_t divided = 0;
    for (int index = 0; index < 81; ++index) {
      BlockTreeN<4>::Cell other;
      int moved = 0;
      for (std::size_t k = 0, rest = static_cast<std::size_t>(index); k < 4; ++k, rest /= 3) {
        other[k] = std::int64_t{b.cell[k]} + static_cast<int>(rest % 3) - 1;
        moved += rest % 3 != 1;
      }
      if (moved > 0 && moved < 4) divided = divided << 1 | (tree.subdivided(b.level, other) ? 1u : 0u);
    }
    const auto [it, fresh] = patterns_.try_emplace(divided);
    if (fresh) {
      BlockCell<4> cell;
      for (std::size_t k = 0; k < 4; ++k) cell[k] = static_cast<std::int32_t>(b.cell[k]);
      it->second = make_pattern(BlockTreeNView<4>(tree), b.level, cell);
    }
    return it->second;  // stays where it is
  }

 private:
  std::unordered_map<std::uint64_t, SpaceTimePattern> patterns_;
};

struct PairHash {
  std::size_t operator()(const std::pair<std::uint32_t, std::uint32_t>& p) const {
    const std::uint64_t h = (std::uint64_t{p.first} << 32 | p.second) * 0x9e3779b97f4a7c15u;
    return static_cast<std::size_t>(h ^ h >> 31);
  }
};

/// Numbers for pairs of numbers, in the order in which they come.
class PairNumbers {
 public:
  /// The number, and whether it is new.
  std::pair<std::uint32_t, bool> of(std::uint32_t a, std::uint32_t b) {
    const auto [it, fresh] = numbers_.try_emplace({a, b}, static_cast<std::uint32_t>(numbers_.size()));
    return {it->second, fresh};
  }

 private:
  std::unordered_map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t, PairHash> numbers_;
};

/// Lattice vertices of some blocks with their values.
struct SpaceTimeValues {
  std::vector<LatticeKey> keys;  ///< increasing
  std::vector<double> values;

  std::uint32_t find(LatticeKey key) const {
    return static_cast<std::uint32_t>(std::lower_bound(keys.begin(), keys.end(), key) - keys.begin());
  }
};

}  // namespace

void SpaceTimeOptions::validate() const {
  if (!(cell > 0 && std::isfinite(cell))) throw ArgumentError(fmt::format("`cell` must be positive, not {}", cell));
  if (!(time_cell > 0 && std::isfinite(time_cell)))
    throw ArgumentError(fmt::format("`time_cell` must be positive, not {}", time_cell));
  if (!(mesh_error >= 0 && std::isfinite(mesh_error)))
    throw ArgumentError(fmt::format("`mesh_error` must be at least 0, not {}", mesh_error));
}

struct SpaceTimeSurface::State {
  const TimeField* field;
  BlockTreeN<4> tree;
  Box3 box;
  TimeRange times;
  int depth = 0;       ///< of the smallest blocks
  Vec3 lower;          ///< of the cube
  double edge = 0;     ///< of the cube (length)
  double lasting = 0;  ///< of the cube (time)
  double mesh_error = 0;

  std::int64_t quarters() const { return std::int64_t{4} << depth; }  ///< across the cube
  double quarter() const { return edge / static_cast<double>(quarters()); }
  double quarter_time() const { return lasting / static_cast<double>(quarters()); }

  Vec3 position(LatticeKey key) const {
    const auto c = [&](std::size_t k) { return static_cast<double>(coordinate(key, k)) * quarter(); };
    return lower + Vec3{c(0), c(1), c(2)};
  }

  /// Distance to the box of the field, negative inside.
  double beyond(const Vec3& x) const {
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) most = std::max({most, box.lower[k] - x[k], x[k] - box.upper[k]});
    return most;
  }

  /// Values of the field within its box; after its last moment it stays as it is.
  void evaluate(std::span<const Vec3> x, std::span<double> t, std::span<double> values) const {
    for (double& moment : t) moment = std::clamp(moment, times.first, times.last);
    for (std::size_t begin = 0; begin < x.size(); begin += kBatch) {
      const std::size_t n = std::min(kBatch, x.size() - begin);
      field->evaluate(x.subspan(begin, n), t.subspan(begin, n), values.subspan(begin, n));
    }
    for (std::size_t i = 0; i < x.size(); ++i) values[i] = off_zero(std::max(values[i], beyond(x[i])));
  }
  double off_zero(double v) const {
    const double least = kNearZero * 4 * quarter();
    if (!std::isfinite(v)) return least;
    return std::abs(v) >= least ? v : std::signbit(v) ? -least : least;
  }

  void divide(Progress& progress);
  std::vector<std::uint8_t> may_hold(std::span<const std::uint32_t> level) const;
  std::vector<std::uint32_t> holding(std::vector<std::uint32_t> blocks) const;
  std::vector<std::uint8_t> are_flat(std::span<const std::uint32_t> blocks) const;

  SpaceTimeValues values_of(std::span<const std::uint32_t> blocks,
                            std::span<const SpaceTimePattern* const> patterns) const {
    SpaceTimeValues result;
    for (std::size_t n = 0; n < blocks.size(); ++n)
      for (const std::uint16_t slot : patterns[n]->slots) result.keys.push_back(key_at(blocks[n], slot));
    parallel_sort(result.keys);
    result.keys.erase(std::unique(result.keys.begin(), result.keys.end()), result.keys.end());
    std::vector<Vec3> x;
    std::vector<double> t;
    for (const LatticeKey key : result.keys) {
      x.push_back(position(key));
      t.push_back(times.first + static_cast<double>(coordinate(key, 3)) * quarter_time());
    }
    result.values.resize(x.size());
    evaluate(x, t, result.values);
    return result;
  }

  LatticeKey key_at(std::uint32_t block, std::uint16_t slot) const {
    const BlockTreeN<4>::Block& b = tree[block];
    std::array<std::int64_t, 4> v;
    for (std::size_t k = 0, rest = slot; k < 4; ++k, rest /= 5)
      v[k] = (4 * std::int64_t{b.cell[k]} + static_cast<std::int64_t>(rest % 5)) << (depth - b.level);
    return key_of(v);
  }
};

/// Whether the surface may pass through the blocks of one level during the times of the field.
std::vector<std::uint8_t> SpaceTimeSurface::State::may_hold(std::span<const std::uint32_t> level) const {
  std::vector<Vec3> x;
  std::vector<double> t;
  std::vector<std::size_t> which;
  std::vector<std::uint8_t> answers(level.size());
  const double scale = 1 / static_cast<double>(1u << tree[level[0]].level);
  const double block = edge * scale, lasts = lasting * scale, radius = std::sqrt(0.75) * block;
  for (std::size_t i = 0; i < level.size(); ++i) {
    const auto& cell = tree[level[i]].cell;
    const Vec3 center = lower + Vec3{cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5} * block;
    const double moment = times.first + (cell[3] + 0.5) * lasts;
    // Blocks after the last moment begin at it or later.
    if (beyond(center) > radius || moment - lasts / 2 > times.last - quarter_time() / 2) continue;
    which.push_back(i), x.push_back(center), t.push_back(std::min(moment, times.last));
  }
  std::vector<ValueRange> found(x.size());
  field->ranges(x, radius, t, lasts / 2, found);
  for (std::size_t n = 0; n < which.size(); ++n) {
    // Cut off at the box the values are max(field, distance to it).
    const double d = beyond(x[n]);
    answers[which[n]] = std::max(found[n].least, d - radius) <= 0 && std::max(found[n].most, d + radius) >= 0;
  }
  return answers;
}

/// Those of some blocks, of any levels, that the surface may pass through, in their order.
std::vector<std::uint32_t> SpaceTimeSurface::State::holding(std::vector<std::uint32_t> blocks) const {
  std::vector<std::uint8_t> hold(blocks.size());
  std::vector<std::vector<std::uint32_t>> of_level(static_cast<std::size_t>(tree.depth()) + 1);
  for (std::size_t i = 0; i < blocks.size(); ++i)
    of_level[tree[blocks[i]].level].push_back(static_cast<std::uint32_t>(i));
  std::vector<std::uint32_t> level;
  for (const std::vector<std::uint32_t>& which : of_level) {
    if (which.empty()) continue;
    level.clear();
    for (const std::uint32_t i : which) level.push_back(blocks[i]);
    const std::vector<std::uint8_t> answers = may_hold(level);
    for (std::size_t n = 0; n < which.size(); ++n) hold[which[n]] = answers[n];
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < blocks.size(); ++i)
    if (hold[i]) blocks[kept++] = blocks[i];
  blocks.resize(kept);
  return blocks;
}

/// Whether the field is linear up to mesh_error in each block, judged by the middles of the lines between opposite
/// corners and between the centres of opposite faces.
std::vector<std::uint8_t> SpaceTimeSurface::State::are_flat(std::span<const std::uint32_t> blocks) const {
  constexpr std::size_t kPlaces = 25;  // centre, faces, corners
  std::vector<std::uint8_t> flat(blocks.size());
  std::vector<Vec3> x;
  std::vector<double> t;
  std::vector<double> values;
  const std::size_t at_once = kBatch / kPlaces;
  for (std::size_t begin = 0; begin < blocks.size(); begin += at_once) {
    const std::size_t n = std::min(at_once, blocks.size() - begin);
    x.clear(), t.clear();
    for (std::size_t i = 0; i < n; ++i) {
      const BlockTreeN<4>::Block& b = tree[blocks[begin + i]];
      const double scale = 1 / static_cast<double>(1u << b.level);
      const auto add = [&](const std::array<double, 4>& u) {
        x.push_back(lower + Vec3{b.cell[0] + u[0], b.cell[1] + u[1], b.cell[2] + u[2]} * (edge * scale));
        t.push_back(times.first + (b.cell[3] + u[3]) * (lasting * scale));
      };
      add({0.5, 0.5, 0.5, 0.5});
      for (std::size_t k = 0; k < 4; ++k)
        for (const double end : {0.0, 1.0}) {
          std::array<double, 4> u{0.5, 0.5, 0.5, 0.5};
          u[k] = end;
          add(u);
        }
      for (unsigned c = 0; c < 8; ++c)  // and the opposite one
        for (const unsigned corner : {c, 15u - c}) {
          std::array<double, 4> u{};
          for (std::size_t k = 0; k < 4; ++k) u[k] = corner >> k & 1u;
          add(u);
        }
    }
    values.resize(x.size());
    evaluate(x, t, values);
    for (std::size_t i = 0; i < n; ++i) {
      const double* v = values.data() + i * kPlaces;
      double most = 0;
      for (std::size_t p = 1; p < kPlaces; p += 2) most = std::max(most, std::abs((v[p] + v[p + 1]) / 2 - v[0]));
      flat[begin + i] = most <= mesh_error;
    }
  }
  return flat;
}

void SpaceTimeSurface::State::divide(Progress& progress) {
  constexpr int kLeastLevel = 3;  // coarser, whole parts may be missed between the places looked at
  std::vector<std::uint32_t> level{0};
  for (int l = 0; l < depth && !level.empty(); ++l) {
    progress.check();
    const std::vector<std::uint8_t> passes = may_hold(level);
    std::vector<std::uint32_t> next;
    for (std::size_t i = 0; i < level.size(); ++i)
      if (passes[i]) next.push_back(level[i]);
    if (mesh_error > 0 && l >= kLeastLevel) {
      const std::vector<std::uint8_t> flat = are_flat(next);
      std::size_t kept = 0;
      for (std::size_t i = 0; i < next.size(); ++i)
        if (!flat[i]) next[kept++] = next[i];
      next.resize(kept);
    }
    // Next to a surface each level has 8 times the blocks of the one above: with 4 nothing is refused that would fit.
    const double more = static_cast<double>(next.size()) * std::exp2(mesh_error > 0 ? 0 : 2 * (depth - 1 - l));
    if (static_cast<double>(tree.size()) + BlockTreeN<4>::kChildren * more > kMostSpaceTimeBlocks)
      throw ArgumentError(fmt::format("`cell` and `time_cell` would make more than {} million blocks",
                                      kMostSpaceTimeBlocks / 1'000'000));
    level = tree.subdivide_all(next);
  }
  tree.balance();
}

SpaceTimeSurface::SpaceTimeSurface(const TimeField& field, const SpaceTimeOptions& options, Progress& progress) {
  options.validate();
  state_ = std::make_unique<State>();
  State& s = *state_;
  s.field = &field;
  s.box = field.bounds();
  s.times = field.times();
  s.mesh_error = options.mesh_error;
  const double span = s.times.last - s.times.first;
  if (!(span > 0 && std::isfinite(span)))
    throw ArgumentError("a surface that moves needs a first and a later last time");
  const double steps = std::ceil(span / options.time_cell - 1e-9);
  const Vec3 size = s.box.size();
  const double across = std::max({size.x, size.y, size.z}) / options.cell + 2 * kAroundField;
  const double blocks = std::max(across, steps);
  if (!(blocks <= std::exp2(kDeepestSpaceTime)))
    throw ArgumentError(fmt::format("`cell` and `time_cell` would need {:.6g} blocks in a row, more than {}", blocks,
                                    1 << kDeepestSpaceTime));
  while (std::exp2(s.depth) < blocks) ++s.depth;
  s.edge = options.cell * std::exp2(s.depth);
  s.lasting = span / steps * std::exp2(s.depth);
  s.lower = s.box.center() - Vec3{1, 1, 1} * (s.edge / 2);
  s.divide(progress);
}

SpaceTimeSurface::~SpaceTimeSurface() = default;
SpaceTimeSurface::SpaceTimeSurface(SpaceTimeSurface&&) noexcept = default;
SpaceTimeSurface& SpaceTimeSurface::operator=(SpaceTimeSurface&&) noexcept = default;

std::size_t SpaceTimeSurface::blocks() const {
  // Each division replaces one leaf by sixteen.
  return state_->tree.size() - (state_->tree.size() - 1) / BlockTreeN<4>::kChildren;
}
double SpaceTimeSurface::cell() const { return 4 * state_->quarter(); }
double SpaceTimeSurface::time_cell() const { return 4 * state_->quarter_time(); }

TriangleMesh SpaceTimeSurface::slice(double t, const Vec3& origin) const {
  const State& s = *state_;
  if (!s.times.contains(t))
    throw ArgumentError(
        fmt::format("the moment {:.9g} does not lie between {:.9g} and {:.9g}", t, s.times.first, s.times.last));
  double moment = (t - s.times.first) / s.quarter_time();
  if (std::abs(moment - std::round(moment)) < 4 * kNearMoment) moment = std::round(moment);
  // Vertices at the moment itself count as after it (at the first moment, when nothing is before, as before it): so
  // each of the faces that lie in it is cut out of one simplex.
  const auto after = [&](std::int64_t time) {
    return moment > 0 ? static_cast<double>(time) >= moment : static_cast<double>(time) > moment;
  };

  std::vector<std::uint32_t> blocks;
  std::vector<std::uint32_t> stack{0};
  while (!stack.empty()) {
    const std::uint32_t b = stack.back();
    stack.pop_back();
    const auto& block = s.tree[b];
    const std::int64_t begin = 4 * std::int64_t{block.cell[3]} << (s.depth - block.level);
    const std::int64_t end = begin + (std::int64_t{4} << (s.depth - block.level));
    if (after(begin) || !after(end)) continue;
    if (s.tree.is_leaf(b)) {
      blocks.push_back(b);
    } else {
      for (std::uint32_t c = BlockTreeN<4>::kChildren; c-- > 0;)
        stack.push_back(static_cast<std::uint32_t>(block.first_child) + c);
    }
  }
  blocks = s.holding(std::move(blocks));
  SpaceTimePatterns table;
  std::vector<const SpaceTimePattern*> patterns;
  patterns.reserve(blocks.size());
  for (const std::uint32_t b : blocks) patterns.push_back(&table.of(s.tree, b));
  const SpaceTimeValues lattice = s.values_of(blocks, patterns);

  // Where edges of the lattice pass the moment, the function there, and the vertices of the surface between two such.
  struct Crossing {
    Vec3 x;
    double value;
  };
  TriangleMesh mesh;
  mesh.origin = origin;
  PairNumbers crossing_numbers, vertex_numbers;
  std::vector<Crossing> crossings;
  const auto crossing_of = [&](std::uint32_t before, std::uint32_t later) {
    const LatticeKey a = lattice.keys[before], b = lattice.keys[later];
    const auto ta = static_cast<double>(coordinate(a, 3)), tb = static_cast<double>(coordinate(b, 3));
    if (tb == moment) before = later;  // all edges that end there
    if (ta == moment) later = before;
    const auto [number, fresh] = crossing_numbers.of(before, later);
    if (!fresh) return number;
    if (before == later) {
      crossings.push_back({s.position(lattice.keys[before]), lattice.values[before]});
    } else {
      const double u = (moment - ta) / (tb - ta);
      crossings.push_back({s.position(a) * (1 - u) + s.position(b) * u,
                           s.off_zero(lattice.values[before] * (1 - u) + lattice.values[later] * u)});
    }
    return number;
  };
  const auto vertex_of = [&](std::uint32_t in, std::uint32_t out) {
    const auto [number, fresh] = vertex_numbers.of(in, out);
    if (fresh) {
      const Crossing &a = crossings[in], &b = crossings[out];
      const double u = a.value / (a.value - b.value);
      mesh.vertices.push_back(Vec3f(a.x * (1 - u) + b.x * u - origin));
    }
    return number;
  };

  std::vector<std::uint32_t> numbers;
  std::vector<std::uint8_t> is_later, is_out;  // of the slots
  for (std::size_t n = 0; n < blocks.size(); ++n) {
    const SpaceTimePattern& pattern = *patterns[n];
    numbers.clear(), is_later.clear(), is_out.clear();
    bool some_in = false, some_out = false;
    for (const std::uint16_t slot : pattern.slots) {
      numbers.push_back(lattice.find(s.key_at(blocks[n], slot)));
      const bool in = lattice.values[numbers.back()] < 0;
      is_out.push_back(!in);
      is_later.push_back(after(coordinate(lattice.keys[numbers.back()], 3)));
      some_in = some_in || in, some_out = some_out || !in;
    }
    if (!some_in || !some_out) continue;
    for (const SpaceTimePattern::Simplex& simplex : pattern.simplices) {
      unsigned later = 0, out = 0;
      for (std::size_t i = 0; i < 5; ++i) {
        later |= static_cast<unsigned>(is_later[simplex.corner[i]]) << i;
        out |= static_cast<unsigned>(is_out[simplex.corner[i]]) << i;
      }
      if (later == 0 || later == 31 || out == 0 || out == 31) continue;
      for (const CutPiece<4>& piece : simplex_cut<4>(later)) {
        std::array<std::uint32_t, 4> tet{};
        unsigned positive = 0;
        for (std::size_t i = 0; i < 4; ++i) {
          tet[i] = crossing_of(numbers[simplex.corner[piece[i].first]], numbers[simplex.corner[piece[i].second]]);
          positive |= static_cast<unsigned>(crossings[tet[i]].value >= 0) << i;
        }
        // What ends in vertices at the moment itself has shrunk to less than a tetrahedron.
        bool whole = true;
        for (std::size_t i = 0; i < 4; ++i)
          for (std::size_t k = 0; k < i; ++k) whole = whole && tet[i] != tet[k];
        if (!whole) continue;
        for (const CutPiece<3>& face : simplex_cut<3>(positive)) {
          Triangle triangle{};
          for (std::size_t i = 0; i < 3; ++i) triangle[i] = vertex_of(tet[face[i].first], tet[face[i].second]);
          if (simplex.turned) std::swap(triangle[1], triangle[2]);
          mesh.triangles.push_back(triangle);
        }
      }
    }
  }
  return mesh;
}

SpaceTimeMesh SpaceTimeSurface::mesh() const {
  const State& s = *state_;
  SpaceTimePatterns table;
  const std::vector<std::uint32_t> blocks = s.holding(s.tree.leaves());
  std::vector<const SpaceTimePattern*> patterns;
  patterns.reserve(blocks.size());
  for (const std::uint32_t b : blocks) patterns.push_back(&table.of(s.tree, b));
  const SpaceTimeValues lattice = s.values_of(blocks, patterns);
  SpaceTimeMesh mesh;
  PairNumbers vertex_numbers;
  std::vector<std::uint32_t> numbers;
  for (std::size_t n = 0; n < blocks.size(); ++n) {
    numbers.clear();
    for (const std::uint16_t slot : patterns[n]->slots) numbers.push_back(lattice.find(s.key_at(blocks[n], slot)));
    for (const SpaceTimePattern::Simplex& simplex : patterns[n]->simplices) {
      unsigned out = 0;
      for (std::size_t i = 0; i < 5; ++i)
        out |= static_cast<unsigned>(lattice.values[numbers[simplex.corner[i]]] >= 0) << i;
      for (const CutPiece<4>& piece : simplex_cut<4>(out)) {
        std::array<std::uint32_t, 4> tet{};
        for (std::size_t i = 0; i < 4; ++i) {
          const std::uint32_t a = numbers[simplex.corner[piece[i].first]], b = numbers[simplex.corner[piece[i].second]];
          const auto [number, fresh] = vertex_numbers.of(a, b);
          tet[i] = number;
          if (!fresh) continue;
          const double u = lattice.values[a] / (lattice.values[a] - lattice.values[b]);
          const LatticeKey p = lattice.keys[a], q = lattice.keys[b];
          const Vec3 x = s.position(p) * (1 - u) + s.position(q) * u;
          const double time =
              (1 - u) * static_cast<double>(coordinate(p, 3)) + u * static_cast<double>(coordinate(q, 3));
          mesh.vertices.push_back({x.x, x.y, x.z, s.times.first + time * s.quarter_time()});
        }
        if (simplex.turned) std::swap(tet[2], tet[3]);
        mesh.tetrahedra.push_back(tet);
      }
    }
  }
  return mesh;
}

}  // namespace sansmesh::inline v1
