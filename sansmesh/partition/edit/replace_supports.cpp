#include "sansmesh/partition/edit/replace_supports.h"

#include <algorithm>

#include "sansmesh/core/boxes.h"
#include "sansmesh/error.h"
#include "sansmesh/partition/assemble.h"
#include "sansmesh/partition/edit/changed_regions.h"

namespace sansmesh::inline v1 {
namespace {

Box3f ball_box(const LocalFunction& f) {
  const Vec3f r{f.radius, f.radius, f.radius};
  return {f.center - r, f.center + r};
}

}  // namespace

EditResult replace_supports(const PartitionData& data, const Selection& chosen, std::vector<FittedLeaf> leaves) {
  EditResult result{data, {}, {}, chosen.size(), leaves.size()};
  std::vector<Box3f> balls;
  balls.reserve(chosen.size() + leaves.size());
  for (const std::uint32_t i : chosen) balls.push_back(ball_box(data.functions[i]));
  for (const FittedLeaf& leaf : leaves) balls.push_back(ball_box(leaf.function));
  result.changed = bounds_of(balls);
  result.regions = changed_regions(balls, {data.lower, data.lower + Vec3f{1, 1, 1} * data.edge});
  const auto position = [](const Support& s) { return curve_position(s.level, s.code); };
  std::stable_sort(leaves.begin(), leaves.end(),
                   [&](const FittedLeaf& a, const FittedLeaf& b) { return position(a.support) < position(b.support); });
  std::vector<LeafRef> all;
  all.reserve(data.supports.size() + leaves.size());
  std::size_t next = 0, gone = 0;
  for (std::size_t i = 0; i < data.supports.size(); ++i) {
    if (gone < chosen.size() && chosen[gone] == i) {
      ++gone;
      continue;
    }
    while (next < leaves.size() && position(leaves[next].support) < position(data.supports[i]))
      all.push_back(ref_of(leaves[next++]));
    all.push_back(ref_of(data, i));
  }
  while (next < leaves.size()) all.push_back(ref_of(leaves[next++]));
  if (all.empty()) throw DataError("no supports would be left");
  assemble(all, result.data);
  return result;
}

}  // namespace sansmesh::inline v1
