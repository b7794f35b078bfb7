#include "sansmesh/polygonize/space_time/space_time_lattice.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/triangulation/block_tree_view.h"

namespace sansmesh::inline v1 {

namespace {

constexpr std::size_t kMostSpaceTimeBlocks = 16'000'000;
/// Lattice coordinates (quarters of blocks of this level) fit into 16 bits.
constexpr int kDeepestSpaceTime = 13;
/// Values closer to zero, in edges of the smallest blocks, are raised to this magnitude: limits how thin triangles are,
/// and keeps positions distinct in float.
constexpr double kNearZero = 1e-3;
/// Least margin of the cube around the field, in smallest blocks.
constexpr double kAroundField = 2;
/// Points per evaluation of the field.
constexpr std::size_t kBatch = std::size_t{1} << 18;

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
    bool odd = false;  // insertion sort that counts exchanges
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

}  // namespace

const SpaceTimePattern& SpaceTimePatterns::of(const BlockTreeN<4>& tree, std::uint32_t block) {
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
  return it->second;
}

SpaceTimeLattice::SpaceTimeLattice(const TimeField& of, double cell, double time_cell, double flat, Progress& progress)
    : field(of), times(of.times()), box_(of.bounds()), mesh_error_(flat) {
  const double span = times.last - times.first;
  if (!(span > 0 && std::isfinite(span)))
    throw ArgumentError("a surface that moves needs a first and a later last time");
  const double steps = std::ceil(span / time_cell - 1e-9);
  const Vec3 size = box_.size();
  const double across = std::max({size.x, size.y, size.z}) / cell + 2 * kAroundField;
  const double blocks = std::max(across, steps);
  if (!(blocks <= std::exp2(kDeepestSpaceTime)))
    throw ArgumentError(fmt::format("`cell` and `time_cell` would need {:.6g} blocks in a row, more than {}", blocks,
                                    1 << kDeepestSpaceTime));
  while (std::exp2(depth) < blocks) ++depth;
  edge_ = cell * std::exp2(depth);
  lasting_ = span / steps * std::exp2(depth);
  lower_ = box_.center() - Vec3{1, 1, 1} * (edge_ / 2);
  divide(progress);
}

std::vector<std::uint8_t> SpaceTimeLattice::may_hold(std::span<const std::uint32_t> level) const {
  std::vector<Vec3> x;
  std::vector<double> t;
  std::vector<std::size_t> which;
  std::vector<std::uint8_t> answers(level.size());
  const double scale = 1 / static_cast<double>(1u << tree[level[0]].level);
  const double block = edge_ * scale, lasts = lasting_ * scale, radius = std::sqrt(0.75) * block;
  for (std::size_t i = 0; i < level.size(); ++i) {
    const auto& cell = tree[level[i]].cell;
    const Vec3 center = lower_ + Vec3{cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5} * block;
    const double moment = times.first + (cell[3] + 0.5) * lasts;
    // Blocks after the last moment begin at it or later.
    if (beyond(center) > radius || moment - lasts / 2 > times.last - quarter_time() / 2) continue;
    which.push_back(i), x.push_back(center), t.push_back(std::min(moment, times.last));
  }
  std::vector<ValueRange> found(x.size());
  field.ranges(x, radius, t, lasts / 2, found);
  for (std::size_t n = 0; n < which.size(); ++n) {
    // Clipped at the box_, the values are max(field, distance to it).
    const double d = beyond(x[n]);
    answers[which[n]] = std::max(found[n].least, d - radius) <= 0 && std::max(found[n].most, d + radius) >= 0;
  }
  return answers;
}

std::vector<std::uint32_t> SpaceTimeLattice::holding(std::vector<std::uint32_t> blocks) const {
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

std::vector<std::uint8_t> SpaceTimeLattice::are_flat(std::span<const std::uint32_t> blocks) const {
  constexpr std::size_t kTestPoints = 25;  // centre, faces, corners
  std::vector<std::uint8_t> flat(blocks.size());
  std::vector<Vec3> x;
  std::vector<double> t;
  std::vector<double> values;
  const std::size_t at_once = kBatch / kTestPoints;
  for (std::size_t begin = 0; begin < blocks.size(); begin += at_once) {
    const std::size_t n = std::min(at_once, blocks.size() - begin);
    x.clear(), t.clear();
    for (std::size_t i = 0; i < n; ++i) {
      const BlockTreeN<4>::Block& b = tree[blocks[begin + i]];
      const double scale = 1 / static_cast<double>(1u << b.level);
      const auto add = [&](const std::array<double, 4>& u) {
        x.push_back(lower_ + Vec3{b.cell[0] + u[0], b.cell[1] + u[1], b.cell[2] + u[2]} * (edge_ * scale));
        t.push_back(times.first + (b.cell[3] + u[3]) * (lasting_ * scale));
      };
      add({0.5, 0.5, 0.5, 0.5});
      for (std::size_t k = 0; k < 4; ++k)
        for (const double end : {0.0, 1.0}) {
          std::array<double, 4> u{0.5, 0.5, 0.5, 0.5};
          u[k] = end;
          add(u);
        }
      for (unsigned c = 0; c < 8; ++c)  // and the opposite corner
        for (const unsigned corner : {c, 15u - c}) {
          std::array<double, 4> u{};
          for (std::size_t k = 0; k < 4; ++k) u[k] = corner >> k & 1u;
          add(u);
        }
    }
    values.resize(x.size());
    evaluate(x, t, values);
    for (std::size_t i = 0; i < n; ++i) {
      const double* v = values.data() + i * kTestPoints;
      double most = 0;
      for (std::size_t p = 1; p < kTestPoints; p += 2) most = std::max(most, std::abs((v[p] + v[p + 1]) / 2 - v[0]));
      flat[begin + i] = most <= mesh_error_;
    }
  }
  return flat;
}

void SpaceTimeLattice::divide(Progress& progress) {
  constexpr int kLeastLevel = 3;  // on coarser levels the sample points could miss whole parts
  std::vector<std::uint32_t> level{0};
  for (int l = 0; l < depth && !level.empty(); ++l) {
    progress.check();
    const std::vector<std::uint8_t> passes = may_hold(level);
    std::vector<std::uint32_t> next;
    for (std::size_t i = 0; i < level.size(); ++i)
      if (passes[i]) next.push_back(level[i]);
    if (mesh_error_ > 0 && l >= kLeastLevel) {
      const std::vector<std::uint8_t> flat = are_flat(next);
      std::size_t kept = 0;
      for (std::size_t i = 0; i < next.size(); ++i)
        if (!flat[i]) next[kept++] = next[i];
      next.resize(kept);
    }
    // Next to a surface each level has 8 times the blocks of the level above; a factor of 4 rejects nothing that would
    // fit.
    const double more = static_cast<double>(next.size()) * std::exp2(mesh_error_ > 0 ? 0 : 2 * (depth - 1 - l));
    if (static_cast<double>(tree.size()) + BlockTreeN<4>::kChildren * more > kMostSpaceTimeBlocks)
      throw ArgumentError(fmt::format("`cell` and `time_cell` would make more than {} million blocks",
                                      kMostSpaceTimeBlocks / 1'000'000));
    level = tree.subdivide_all(next);
  }
  tree.balance();
}

Vec3 SpaceTimeLattice::position(LatticeKey key) const {
  const auto c = [&](std::size_t k) { return static_cast<double>(coordinate(key, k)) * quarter(); };
  return lower_ + Vec3{c(0), c(1), c(2)};
}

double SpaceTimeLattice::beyond(const Vec3& x) const {
  double most = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 3; ++k) most = std::max({most, box_.lower[k] - x[k], x[k] - box_.upper[k]});
  return most;
}

void SpaceTimeLattice::evaluate(std::span<const Vec3> x, std::span<double> t, std::span<double> values) const {
  for (double& moment : t) moment = std::clamp(moment, times.first, times.last);
  for (std::size_t begin = 0; begin < x.size(); begin += kBatch) {
    const std::size_t n = std::min(kBatch, x.size() - begin);
    field.evaluate(x.subspan(begin, n), t.subspan(begin, n), values.subspan(begin, n));
  }
  for (std::size_t i = 0; i < x.size(); ++i) values[i] = off_zero(std::max(values[i], beyond(x[i])));
}

double SpaceTimeLattice::off_zero(double v) const {
  const double least = kNearZero * 4 * quarter();
  if (!std::isfinite(v)) return least;
  return std::abs(v) >= least ? v : std::signbit(v) ? -least : least;
}

SpaceTimeBlocks SpaceTimeLattice::crossed(std::vector<std::uint32_t> blocks) const {
  SpaceTimeBlocks result;
  result.blocks = holding(std::move(blocks));
  for (const std::uint32_t b : result.blocks) {
    result.patterns.push_back(&result.table.of(tree, b));
    for (const std::uint16_t slot : result.patterns.back()->slots) result.keys.push_back(key_at(b, slot));
  }
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

LatticeKey SpaceTimeLattice::key_at(std::uint32_t block, std::uint16_t slot) const {
  const BlockTreeN<4>::Block& b = tree[block];
  std::array<std::int64_t, 4> v;
  for (std::size_t k = 0, rest = slot; k < 4; ++k, rest /= 5)
    v[k] = (4 * std::int64_t{b.cell[k]} + static_cast<std::int64_t>(rest % 5)) << (depth - b.level);
  return key_of(v);
}

}  // namespace sansmesh::inline v1
