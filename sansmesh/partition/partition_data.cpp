#include "sansmesh/partition/partition_data.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/morton.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/partition/fit/sample_tree.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {
namespace {

/// Upper bound for coefficients and distances of functions of samples with coordinates about 1.
constexpr float kHuge = 1e9f;
/// Range of the root cube's edge that leaves enough precision for its blocks.
constexpr float kLeastEdge = 1e-9f, kMostEdge = 1e9f;
/// Blocks of meshes are one level deeper than the fits.
constexpr int kDeepest = BlockTree::kMaxLevel - 1;

bool sensible(float x) { return std::abs(x) <= kHuge; }  // false for NaN
bool sensible(const Vec3f& v) { return sensible(v.x) && sensible(v.y) && sensible(v.z); }

/// Rounding error in the products of a frame's axes; the bounds of slopes allow for its effect.
bool is_rounding(float x) { return std::abs(x) <= 2e-5f; }

bool is_frame(const LocalFunction& f) {
  return is_rounding(squared_norm(f.xi) - 1) && is_rounding(squared_norm(f.eta) - 1) &&
         is_rounding(squared_norm(f.nu) - 1) && is_rounding(dot(f.xi, f.eta)) && is_rounding(dot(f.eta, f.nu)) &&
         is_rounding(dot(f.nu, f.xi));
}

/// Whether f is a polynomial of its degree that is far from the limits of float within a ball of this radius around its
/// support's centre.
bool is_sensible_piece(const LocalFunction& f, const Vec3f& center, float radius) {
  if (!(sensible(f.center) && f.center == center && f.radius >= 0 && sensible(f.radius) && f.scale > 0 &&
        sensible(f.scale) && f.degree >= 0 && f.degree <= kMaxDegree && f.convex <= 1))
    return false;
  const bool shaped =
      f.is_constant() ? f.degree == 0 && f.xi == Vec3f{} && f.eta == Vec3f{} : f.scale >= 0.25f * radius && is_frame(f);
  const auto beyond = f.coefficient.begin() + kBasisSize[static_cast<std::size_t>(f.degree)];
  return shaped && std::all_of(f.coefficient.begin(), beyond, [](float c) { return sensible(c); }) &&
         std::all_of(beyond, f.coefficient.end(), [](float c) { return c == 0; });
}

bool is_sensible_support(const PartitionData& data, std::size_t i) {
  const Support& s = data.supports[i];
  const LocalFunction& f = data.functions[i];
  if (s.level >= data.flatness.size() || s.code >> (3 * s.level) != 0) return false;
  const float h = data.edge / static_cast<float>(1u << s.level);
  const std::array<std::uint32_t, 3> cell = morton_cell(s.code);
  // Far too many points would meet a ball much larger than its block.
  const float reach = 0.8660254f * h;
  bool ok = f.radius >= 0.9f * reach && f.radius <= 4.1f * reach && is_sensible_piece(f, f.center, f.radius);
  for (std::size_t k = 0; k < 3; ++k)
    ok &= std::abs(f.center[k] - (data.lower[k] + (static_cast<float>(cell[k]) + 0.5f) * h)) <= 0.5f * h;
  return ok && s.area >= 0 && s.area <= 4 * h * h && sensible(s.foot) &&
         (s.area == 0 || norm(s.foot - f.center) <= 2 * h) && sensible(s.error) && sensible(s.coverage) &&
         s.state <= Support::constant && s.creased <= 1 && s.open <= 1;
}

/// Whether b follows a along the Morton curve, without overlap.
bool in_order(const Support& a, const Support& b) {
  const auto start_of = [](int level, std::uint64_t code) { return code << (3 * (kDeepest - level)); };
  return start_of(a.level, a.code + 1) <= start_of(b.level, b.code);
}

/// Further pieces follow the functions of the supports, those of each support together and in its order. Therefore
/// chains end, and no piece belongs to two supports.
bool is_chained(const PartitionData& data) {
  const auto& functions = data.functions;
  const auto next = [&](std::size_t i) { return static_cast<std::int64_t>(functions[i].next); };
  std::size_t at = data.supports.size();
  for (std::size_t i = 0; i < data.supports.size(); ++i) {
    if (next(i) == 0) continue;
    if (next(i) != static_cast<std::int64_t>(at) + 1) return false;
    for (;; ++at) {
      if (at >= functions.size() || !is_sensible_piece(functions[at], functions[i].center, functions[i].radius))
        return false;
      if (next(at) == 0) break;
      if (next(at) != static_cast<std::int64_t>(at) + 2) return false;
    }
    ++at;
  }
  return at == functions.size();
}

/// Calls use(piece, bound) for the pieces of a support.
template <class Use>
void for_each_slope(const PartitionData& data, std::size_t support, const Use& use) {
  const LocalFunction& first = data.functions[support];
  use(support, local_slope(first, first.center, first.radius));
  for (std::int32_t next = first.next; next != 0;) {
    const auto piece = static_cast<std::size_t>(next - 1);
    use(piece, local_slope(data.functions[piece], first.center, first.radius));
    next = data.functions[piece].next;
  }
}

template <class Check>
bool all_of_range(std::size_t n, Check&& check) {
  return parallel_reduce(
      n, std::size_t{8192}, true,
      [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
          if (!check(i)) return false;
        return true;
      },
      [](bool a, bool b) { return a && b; });
}

/// Whether each level's cells are in order, and the children of the level above.
bool is_tree(const std::vector<PartitionData::Flatness>& levels) {
  if (levels.empty() || levels[0].code.size() != 1 || levels[0].code[0] != 0) return false;
  for (std::size_t l = 0; l < levels.size(); ++l) {
    const PartitionData::Flatness& level = levels[l];
    const std::size_t n = level.code.size();
    if (level.gap.size() != n) return false;
    if (!all_of_range(
            n, [&](std::size_t c) { return level.gap[c] >= 0 && (c == 0 || level.code[c - 1] < level.code[c]); }))
      return false;
    if (l + 1 == levels.size()) return level.child.empty();
    const auto& below = levels[l + 1].code;
    if (level.child.size() != n + 1 || level.child[0] != 0 || level.child[n] != below.size()) return false;
    const bool fits = all_of_range(n, [&](std::size_t c) {
      const std::uint32_t first = level.child[c], last = level.child[c + 1];
      if (first > last || last > below.size()) return false;
      return std::all_of(below.begin() + first, below.begin() + last,
                         [&](std::uint64_t code) { return code >> 3 == level.code[c]; });
    });
    if (!fits) return false;
  }
  return true;
}

}  // namespace

void PartitionOptions::validate() const {
  if (max_depth) check_range("max_depth", *max_depth, kLeastDepth, kMostDepth);
  check_argument(!error || (std::isfinite(*error) && *error > 0), "`error` must be a positive length");
  if (support) check_range("support", *support, 1.1, 2);
  check_range("max_degree", max_degree, 1, kMaxDegree);
  check_range("min_samples", min_samples, 3, 1000);
  check_argument(max_samples >= 50, "`max_samples` must be at least 50");
}

void PartitionData::find_slopes() {
  std::vector<float> found(functions.size());
  parallel_for(0, supports.size(), 2048, [&](std::size_t i) {
    for_each_slope(*this, i, [&](std::size_t piece, float slope) { found[piece] = slope; });
  });
  slopes = std::move(found);
}

void PartitionData::validate() const {
  const auto check = [](bool ok, const char* what) {
    if (!ok) throw DataError(what);
  };
  options.validate();
  if (paper) paper->validate();
  check(edge >= kLeastEdge && edge <= kMostEdge && sensible(lower) && norm(origin) <= kHuge &&
            norm(Vec3(lower)) <= 1e3 * static_cast<double>(edge),
        "its cube is invalid");
  check(!supports.empty() && functions.size() >= supports.size(), "it has no functions");
  check(functions.size() < (std::size_t{1} << 31), "it has too many functions");
  const auto is_size = [](double x) { return x >= 0 && x <= static_cast<double>(kHuge); };
  check(is_size(report.noise) && is_size(report.error) && is_size(report.accuracy) && is_size(report.area) &&
            is_size(report.spacing) && report.spacing > 0 && is_size(report.open_area) &&
            sensible(static_cast<float>(report.mean_winding_number)) && report.depth >= 0 && report.depth <= kDeepest,
        "its report is invalid");
  check(basis.sort_depth >= 0 && basis.sort_depth <= 20 && basis.tried >= 0 && basis.tried <= basis.sort_depth &&
            basis.finest >= 0 && basis.finest <= basis.tried && basis.finest <= kDeepest && is_size(basis.variance) &&
            is_size(basis.accepted) && basis.support >= 1 && basis.support <= 4 && basis.fit >= 1 && basis.fit <= 4 &&
            is_size(basis.height),
        "its scales are invalid");
  check(flatness.size() == static_cast<std::size_t>(basis.finest) + 1 && is_tree(flatness), "its tree is invalid");
  const std::size_t n = supports.size();
  check(all_of_range(n,
                     [&](std::size_t i) {
                       return is_sensible_support(*this, i) && (i == 0 || in_order(supports[i - 1], supports[i]));
                     }),
        "a support is invalid");
  check(is_chained(*this), "the pieces of its creases are invalid");
  // Bounds, up to the last bits of another machine's cosines.
  const auto are_slopes = [&](std::size_t support) {
    bool ok = true;
    for_each_slope(*this, support, [&](std::size_t piece, float least) {
      ok &= slopes[piece] >= least * (1 - 1e-6f) && slopes[piece] <= least * (1 + 1e-3f);
    });
    return ok;
  };
  check(slopes.empty() || (slopes.size() == functions.size() && all_of_range(n, are_slopes)),
        "the slopes of its functions are invalid");
}

}  // namespace sansmesh::inline v1
