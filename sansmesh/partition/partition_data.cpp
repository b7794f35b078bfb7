#include "sansmesh/partition/partition_data.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh {
namespace {

/// No coefficient, scale or distance of a function of samples that are about 1 large comes near this.
constexpr float kHuge = 1e9f;

bool sensible(float x) { return std::abs(x) <= kHuge; }  // false for NaN
bool sensible(const Vec3f& v) { return sensible(v.x) && sensible(v.y) && sensible(v.z); }
bool at_most_unit(const Vec3f& v) { return squared_norm(v) <= 1.01f; }

/// `i`: its own place; pieces of creases stand behind the functions of the supports, in rising order, so that following
/// them ends.
bool sensible(const LocalFunction& f, std::size_t i, std::size_t supports, std::size_t functions) {
  const auto next = static_cast<std::size_t>(f.next);
  return sensible(f.center) && f.radius >= 0 && sensible(f.radius) && f.scale > 0 && sensible(f.scale) &&
         at_most_unit(f.xi) && at_most_unit(f.eta) && at_most_unit(f.nu) && f.degree >= 0 && f.degree <= kMaxDegree &&
         f.next >= 0 && (f.next == 0 || (next > supports && next - 1 > i && next <= functions)) && f.convex <= 1 &&
         std::all_of(f.coefficient.begin(), f.coefficient.end(), [](float c) { return sensible(c); });
}

bool sensible(const Support& s, std::size_t levels) {
  return s.level < levels && s.code >> (3 * s.level) == 0 && sensible(s.foot) && s.area >= 0 && sensible(s.area) &&
         sensible(s.error) && sensible(s.coverage) && s.state <= Support::constant && s.creased <= 1;
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

/// Each level's cells are in order, and the children of the level above.
bool is_tree(const std::vector<PartitionData::Flatness>& levels) {
  if (levels.empty() || levels[0].code.size() != 1 || levels[0].code[0] != 0) return false;
  for (std::size_t l = 0; l < levels.size(); ++l) {
    const PartitionData::Flatness& level = levels[l];
    const std::size_t n = level.code.size();
    if (level.gap.size() != n) return false;
    if (!all_of_range(
            n, [&](std::size_t c) { return !(level.gap[c] < 0) && (c == 0 || level.code[c - 1] < level.code[c]); }))
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

void PartitionData::validate() const {
  const auto check = [](bool ok, const char* what) {
    if (!ok) throw DataError(what);
  };
  options.validate();
  check(is_finite(origin) && sensible(lower) && edge > 0 && sensible(edge), "its cube makes no sense");
  check(!supports.empty() && functions.size() >= supports.size(), "it has no functions");
  check(report.noise >= 0 && report.accuracy >= 0 && report.spacing >= 0 && std::isfinite(report.noise) &&
            std::isfinite(report.accuracy) && std::isfinite(report.spacing),
        "its report makes no sense");
  check(basis.sort_depth >= 0 && basis.sort_depth <= 20 && basis.tried >= 0 && basis.tried <= basis.sort_depth &&
            basis.finest >= 0 && basis.finest <= basis.tried && basis.variance >= 0 && basis.accepted >= 0 &&
            basis.support >= 1 && basis.support <= 4,
        "its scales make no sense");
  check(flatness.size() == static_cast<std::size_t>(basis.finest) + 1 && is_tree(flatness), "its tree makes no sense");
  const std::size_t n = supports.size(), m = functions.size();
  check(all_of_range(m, [&](std::size_t i) { return sensible(functions[i], i, n, m); }),
        "a local function makes no sense");
  check(
      all_of_range(n, [&](std::size_t i) { return functions[i].radius > 0 && sensible(supports[i], flatness.size()); }),
      "a support makes no sense");
}

}  // namespace sansmesh
