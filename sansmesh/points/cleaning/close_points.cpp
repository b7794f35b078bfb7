#include "sansmesh/points/cleaning/close_points.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sansmesh/box.h"
#include "sansmesh/core/largest_first.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/error.h"
#include "sansmesh/search/box_levels.h"
#include "sansmesh/search/equal_positions.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/search/neighbour.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::uint32_t kUnclaimed = ~std::uint32_t{0};
constexpr std::size_t kQueriesAtOnce = 1 << 14;

void check_distance(double distance) {
  if (!(distance >= 0 && distance < 1e18)) throw ArgumentError("a distance between points must lie in 0..1e18");
}

/// Points in tree order, in runs of eight points, eight runs and so on. A run whose points are all within the distance
/// of each other counts as one point, so that many coincident points cost no more than one.
class CompactRuns {
 public:
  CompactRuns(const KdTree& tree, float distance) : limit_(distance * distance), points_(tree.positions()) {
    std::vector<Box3f> boxes(runs_of(points_.size()));
    parallel_for(0, boxes.size(), 4096, [&](std::size_t r) {
      for (std::size_t s = r * kTreeWidth; s < std::min(points_.size(), (r + 1) * kTreeWidth); ++s)
        boxes[r].extend(points_[s]);
    });
    levels_.push_back(std::move(boxes));
    while (levels_.back().size() > 1) {
      const std::vector<Box3f>& below = levels_.back();
      std::vector<Box3f> above(runs_of(below.size()));
      for (std::size_t r = 0; r < below.size(); ++r) above[r / kTreeWidth].extend(below[r]);
      levels_.push_back(std::move(above));
    }
    first_.resize(points_.size());
    if (!points_.empty()) find_runs(levels_.size() - 1, 0);
  }

  std::size_t size() const { return points_.size(); }
  /// First of the points that are merged with this one.
  std::uint32_t first(std::size_t slot) const { return first_[slot]; }

  /// Calls close(first) for one point of each run before that of `slot` that contains a close point.
  template <class Close>
  void for_each_close_before(std::uint32_t slot, const Close& close) const {
    look(levels_.size() - 1, 0, slot, close);
  }

 private:
  static std::size_t runs_of(std::size_t n) { return (n + kTreeWidth - 1) / kTreeWidth; }
  /// Slots of a run of a level.
  std::size_t begin(std::size_t level, std::size_t run) const { return run << (3 * (level + 1)); }
  std::size_t end(std::size_t level, std::size_t run) const { return std::min(begin(level, run + 1), points_.size()); }
  std::size_t end_below(std::size_t level, std::size_t run) const {
    return std::min((run + 1) * kTreeWidth, levels_[level - 1].size());
  }
  // Rounding is monotone: no two points of a box are farther apart than its corners, and no point of a box is farther
  // from a point than its corners.
  bool compact(std::size_t level, std::size_t run) const {
    const Box3f& box = levels_[level][run];
    return squared_distance(box.upper, box.lower) <= limit_;
  }

  void find_runs(std::size_t level, std::size_t run) {
    if (compact(level, run)) {
      for (std::size_t s = begin(level, run); s < end(level, run); ++s)
        first_[s] = static_cast<std::uint32_t>(begin(level, run));
    } else if (level > 0) {
      for (std::size_t r = run * kTreeWidth; r < end_below(level, run); ++r) find_runs(level - 1, r);
    } else {
      for (std::size_t s = begin(0, run); s < end(0, run); ++s) first_[s] = static_cast<std::uint32_t>(s);
    }
  }

  bool beside(std::size_t level, std::size_t run, const Vec3f& p) const {
    const Box3f& box = levels_[level][run];
    Vec3f gap;
    for (std::size_t k = 0; k < 3; ++k) gap[k] = std::max({box.lower[k] - p[k], p[k] - box.upper[k], 0.0f});
    return gap.x * gap.x + gap.y * gap.y + gap.z * gap.z <= limit_;
  }

  template <class Close>
  void look(std::size_t level, std::size_t run, std::uint32_t slot, const Close& close) const {
    if (begin(level, run) >= first_[slot] || !beside(level, run, points_[slot])) return;
    if (compact(level, run)) {
      if (any_close(level, run, points_[slot])) close(first_[begin(level, run)]);
    } else if (level > 0) {
      for (std::size_t r = run * kTreeWidth; r < end_below(level, run); ++r) look(level - 1, r, slot, close);
    } else {
      for (std::size_t s = begin(0, run); s < end(0, run) && s < first_[slot]; ++s)
        if (squared_distance(points_[s], points_[slot]) <= limit_) close(first_[s]);
    }
  }

  bool any_close(std::size_t level, std::size_t run, const Vec3f& p) const {
    if (!beside(level, run, p)) return false;
    const Box3f& box = levels_[level][run];
    Vec3f far;
    for (std::size_t k = 0; k < 3; ++k) far[k] = std::max(std::abs(box.lower[k] - p[k]), std::abs(p[k] - box.upper[k]));
    if (far.x * far.x + far.y * far.y + far.z * far.z <= limit_) return true;
    if (level == 0)
      return std::any_of(points_.begin() + static_cast<std::ptrdiff_t>(begin(0, run)),
                         points_.begin() + static_cast<std::ptrdiff_t>(end(0, run)),
                         [&](const Vec3f& other) { return squared_distance(other, p) <= limit_; });
    for (std::size_t r = run * kTreeWidth; r < end_below(level, run); ++r)
      if (any_close(level - 1, r, p)) return true;
    return false;
  }

  float limit_;
  std::vector<Vec3f> points_;
  std::vector<std::vector<Box3f>> levels_;
  std::vector<std::uint32_t> first_;
};

}  // namespace

std::vector<std::uint32_t> close_representatives(std::span<const Vec3f> positions, double distance) {
  check_distance(distance);
  if (distance == 0) return first_equal_positions(positions);
  const KdTree tree(positions);
  std::vector<std::uint32_t> of(positions.size(), kUnclaimed);
  std::vector<Neighbour> near;
  for (std::uint32_t i = 0; i < of.size(); ++i) {
    if (of[i] != kUnclaimed) continue;
    of[i] = i;
    tree.within(positions[i], static_cast<float>(distance), near);
    for (const Neighbour& n : near)
      if (of[n.index] == kUnclaimed) of[n.index] = i;
  }
  return of;
}

CloudComponents find_cloud_components(std::span<const Vec3f> positions, double distance, Progress& progress) {
  check_distance(distance);
  const KdTree tree(positions);
  const std::span<const std::uint32_t> order = tree.order();
  const CompactRuns runs(tree, static_cast<float>(distance));
  progress.begin("components", tree.size());
  UnionFind sets(positions.size());
  for (std::size_t slot = 0; slot < runs.size(); ++slot) sets.join(order[runs.first(slot)], order[slot]);
  // Parallel queries, sequential joins.
  struct Edge {
    std::uint32_t a, b;
  };
  std::vector<std::vector<Edge>> edges;
  for (std::size_t first = 0; first < tree.size(); first += kQueriesAtOnce) {
    const std::size_t last = std::min(tree.size(), first + kQueriesAtOnce);
    constexpr std::size_t kShare = 1 << 10;
    edges.assign((last - first + kShare - 1) / kShare, {});
    parallel_for(0, edges.size(), 1, [&](std::size_t c) {
      const std::size_t begin = first + c * kShare, end = std::min(last, begin + kShare);
      for (std::size_t slot = begin; slot < end; ++slot)
        runs.for_each_close_before(static_cast<std::uint32_t>(slot), [&](std::uint32_t other) {
          edges[c].push_back({order[slot], order[other]});
        });
    });
    for (const std::vector<Edge>& some : edges)
      for (const Edge& e : some) sets.join(e.a, e.b);
    progress.advance(last - first);
  }
  CloudComponents result;
  result.of_point.resize(positions.size());
  std::vector<std::uint32_t> number(positions.size(), kUnclaimed);
  for (std::uint32_t i = 0; i < number.size(); ++i) {
    std::uint32_t& c = number[sets.find(i)];
    if (c == kUnclaimed) {
      c = static_cast<std::uint32_t>(result.points.size());
      result.points.push_back(0);
    }
    result.of_point[i] = c;
    ++result.points[c];
  }
  number_largest_first(result.of_point, result.points);
  return result;
}

}  // namespace sansmesh::inline v1
