#include "sansmesh/points/orientation/inward_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/points/orientation/relation_graph.h"
#include "sansmesh/points/orientation/sign_parts.h"
#include "sansmesh/points/orientation/winding_sides.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

using detail::Parts, detail::RelationGraph, detail::WindingSides;

constexpr int kInwardNeighbours = 10;
/// Least number of samples of a part, and largest number of parts.
constexpr std::size_t kFewestOfClosed = 200, kMostClosed = 300;
/// Least outwardness (Parts) of a clear side, and relative variance of the winding number of a closed part.
constexpr double kClearlyOutward = 0.2, kClosedVariance = 0.3;
/// Largest numbers of samples that determine whether a part is inside another.
constexpr std::size_t kNestingTests = 32, kNestingSources = 4000;

/// Closed part of the cloud.
struct Shell {
  std::uint32_t part = 0;
  std::vector<std::uint32_t> members;
  Box3f box;
  bool inward = false;  ///< direction of most given normals
  bool flip = false;
  std::vector<std::size_t> around;  ///< shells that contain it
};

/// Winding number of a shell, with its normals outward, at a point off it.
double winding_number(const RelationGraph& graph, const Parts& parts, const Shell& shell, const Vec3& x) {
  const std::size_t step = 1 + shell.members.size() / kNestingSources;
  const double outward = parts.outwardness[shell.part] < 0 ? -1 : 1;
  double sum = 0;
  for (std::size_t i = 0; i < shell.members.size(); i += step) {
    const std::uint32_t s = shell.members[i];
    const Vec3 d = Vec3(graph.positions()[s]) - x;
    const double square = squared_norm(d);
    if (!(square > 0)) continue;
    sum += static_cast<double>(graph.area()[s]) * parts.sign[s] * dot(Vec3(graph.normals()[s]), d) /
           (square * std::sqrt(square));
  }
  // The area of a sample is π times the squared distance of its last neighbour, divided by their number.
  return outward * sum * static_cast<double>(step) / (4.0 * static_cast<double>(graph.degree()));
}

bool is_inside(const RelationGraph& graph, const Parts& parts, const Shell& inner, const Shell& outer) {
  if (!outer.box.contains(inner.box.lower) || !outer.box.contains(inner.box.upper)) return false;
  const std::size_t step = 1 + inner.members.size() / kNestingTests;
  std::vector<double> winding;
  for (std::size_t i = step / 2; i < inner.members.size(); i += step)
    winding.push_back(winding_number(graph, parts, outer, Vec3(graph.positions()[inner.members[i]])));
  return median(winding) > 0.5;
}

/// Closed parts with a clear side, the largest first.
std::vector<Shell> find_shells(const RelationGraph& graph, const Parts& parts, bool confirm) {
  std::vector<Shell> shells(parts.count);
  std::vector<std::size_t> negative(parts.count);
  for (std::uint32_t s = 0; s < graph.size(); ++s) {
    Shell& shell = shells[parts.part[s]];
    shell.part = parts.part[s];
    shell.members.push_back(s);
    shell.box.extend(graph.positions()[s]);
    negative[parts.part[s]] += parts.sign[s] < 0;
  }
  std::erase_if(shells, [&](Shell& shell) {
    const double outwardness = parts.outwardness[shell.part];
    if (shell.members.size() < kFewestOfClosed || parts.open[shell.part]) return true;
    if (!(std::abs(outwardness) > kClearlyOutward)) return true;
    // Most given normals are opposite to the signs of the part.
    const bool turned = 2 * negative[shell.part] > shell.members.size();
    shell.inward = (outwardness < 0) != turned;
    return false;
  });
  std::stable_sort(shells.begin(), shells.end(),
                   [](const Shell& a, const Shell& b) { return a.members.size() > b.members.size(); });
  if (shells.size() > kMostClosed) shells.resize(kMostClosed);
  if (confirm)
    std::erase_if(shells, [&](const Shell& shell) {
      const std::size_t step = 1 + shell.members.size() / kNestingSources;
      return WindingSides(graph, shell.members, step).error(parts.sign) > kClosedVariance;
    });
  return shells;
}

/// Marks the shells to flip, from the outermost to the innermost.
void mark_inward(const RelationGraph& graph, const Parts& parts, std::vector<Shell>& shells) {
  parallel_for(0, shells.size(), 1, [&](std::size_t i) {
    for (std::size_t j = 0; j < shells.size(); ++j)
      if (i != j && is_inside(graph, parts, shells[i], shells[j])) shells[i].around.push_back(j);
  });
  std::vector<std::size_t> order(shells.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return shells[a].around.size() < shells[b].around.size(); });
  for (const std::size_t i : order) {
    Shell& shell = shells[i];
    int winding = 0;
    for (const std::size_t j : shell.around) {
      const Shell& outer = shells[j];
      // Inverted as a whole: parts inside turn with the outermost one.
      if (outer.around.empty()) shell.flip = shell.flip || outer.flip;
      winding += outer.inward != outer.flip ? -1 : 1;
    }
    // The winding number inside must not become negative.
    if (shell.inward != shell.flip && winding <= 0) shell.flip = !shell.flip;
  }
}

}  // namespace

std::size_t flip_inward_parts(PointSet& points, double noise, bool mostly, Progress& progress) {
  const KdTree tree(points.positions);
  const RelationGraph graph(tree, points.normals, kInwardNeighbours, noise);
  Parts parts = propagated_parts(graph, {}, progress);
  judge_outwardness(graph, parts);
  std::vector<Shell> shells = find_shells(graph, parts, !mostly);
  mark_inward(graph, parts, shells);
  const bool all = mostly && std::all_of(shells.begin(), shells.end(), [](const Shell& s) { return s.flip; });
  std::vector<std::uint8_t> flip(parts.count, all);
  for (const Shell& shell : shells) flip[shell.part] = shell.flip;
  std::size_t flipped = 0;
  for (std::size_t s = 0; s < graph.size(); ++s) {
    if (!flip[parts.part[s]]) continue;
    Vec3f& normal = points.normals[tree.order()[s]];
    normal = -normal;
    ++flipped;
  }
  return flipped;
}

}  // namespace sansmesh::inline v1
