#include "sansmesh/points/hidden_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "sansmesh/core/parallel.h"
#include "sansmesh/points/sign_parts.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1::detail {
namespace {

/// Neighbours in the plan view, and number of these above and in another sheet from which a sample is hidden.
constexpr std::size_t kPlanNeighbours = 48, kFewestAbove = 2;
/// Largest relation of two upward normals of different sheets.
constexpr float kOtherSheet = -0.5f;
/// Samples of one sheet differ in height by up to this many noise levels.
constexpr double kThickness = 5;
constexpr float kApart = 3;
/// Rounds in which the neighbours of hidden samples in their patch count as hidden, too: at its rim a sheet may seem
/// visible.
constexpr int kRimRounds = 2;
/// Share of a smooth patch from which all of it counts as hidden.
constexpr double kHiddenPatch = 0.6;

/// Whether q is above p in another sheet. `n` and `m` are their upward normals. On one sheet these are mirror images in
/// the bisecting plane of the chord (as in RelationGraph); across two they are not.
bool is_above(const Vec3f& p, const Vec3f& n, const Vec3f& q, const Vec3f& m, float unseen, float apart) {
  const Vec3f d = q - p;
  const float a = dot(n, d), b = dot(m, d);
  if (!(d.z > 0) || !(std::min(std::abs(a), std::abs(b)) > unseen)) return false;
  if (std::min(std::abs(a), std::abs(b)) > apart) return true;
  return dot(n, m) - 2 * a * b / squared_norm(d) < kOtherSheet;
}

/// Extends hidden regions by their neighbours within smooth patches.
void extend(const RelationGraph& graph, std::vector<std::uint8_t>& hidden) {
  const std::vector<std::uint8_t> before = hidden;
  parallel_for(0, graph.size(), 8192, [&](std::size_t s) {
    for (std::size_t k = 0; k < graph.degree() && !hidden[s]; ++k)
      hidden[s] = before[graph.neighbour(s, k)] && std::abs(graph.relation_to(s, k)) >= kSure[3];
  });
}

/// Hides smooth patches that are mostly hidden.
void hide_patches(const RelationGraph& graph, std::span<const std::uint32_t> known, std::vector<std::uint8_t>& hidden) {
  SignForest patches(graph.size());
  join_stretches(graph, patches, kSure[0]);
  for (const int sure : kSure) join_sure(graph, patches, sure);
  std::vector<std::uint32_t> members(graph.size()), beneath(graph.size());
  for (const std::uint32_t s : known) {
    const std::uint32_t patch = patches.flat_root(s).index;
    ++members[patch], beneath[patch] += hidden[s];
  }
  for (const std::uint32_t s : known) {
    const std::uint32_t patch = patches.flat_root(s).index;
    if (static_cast<double>(beneath[patch]) > kHiddenPatch * static_cast<double>(members[patch])) hidden[s] = 1;
  }
}

}  // namespace

std::vector<std::uint8_t> find_hidden_from_above(const RelationGraph& graph) {
  static const int level = getenv("SM_LEVEL") ? atoi(getenv("SM_LEVEL")) : 90;
  static const unsigned least = getenv("SM_LEAST") ? atoi(getenv("SM_LEAST")) : 200;
  std::vector<std::uint8_t> hidden(graph.size());
  SignForest sheets(graph.size());
  join_stretches(graph, sheets, level);
  join_sure(graph, sheets, level);
  std::vector<std::uint32_t> in(graph.size());
  for (std::uint32_t s = 0; s < graph.size(); ++s) ++in[sheets.flat_root(s).index];
  std::vector<std::uint32_t> known, covers;
  std::vector<Vec3f> plan;
  const auto in_plan = [&](std::size_t s) { return Vec3f{graph.positions()[s].x, graph.positions()[s].y, 0}; };
  for (std::uint32_t s = 0; s < graph.size(); ++s) {
    if (!(std::abs(graph.normals()[s].z) > kLeastSensorCosine) || !graph.firm(s)) continue;
    known.push_back(s);
    if (in[sheets.flat_root(s).index] < least) continue;
    covers.push_back(s);
    plan.push_back(in_plan(s));
  }
  const KdTree tree(plan);
  const auto unseen = static_cast<float>(kThickness * graph.noise());
  const auto upward = [&](std::uint32_t s) {
    const Vec3f& n = graph.normals()[s];
    return n.z < 0 ? -n : n;
  };
  parallel_for(0, known.size(), 256, [&](std::size_t i) {
    const std::uint32_t s = known[i];
    std::array<Neighbour, kPlanNeighbours> found;
    const std::size_t n = tree.nearest(in_plan(s), found);
    if (n == 0) return;
    std::size_t above = 0;
    const float apart = kApart * std::sqrt(found[n - 1].squared_distance);
    for (std::size_t k = 0; k < n; ++k) {
      const std::uint32_t q = covers[found[k].index];
      above += is_above(graph.positions()[s], upward(s), graph.positions()[q], upward(q), unseen, apart);
    }
    hidden[s] = above >= kFewestAbove;
  });
  for (int round = 0; round < kRimRounds; ++round) extend(graph, hidden);
  hide_patches(graph, known, hidden);
  return hidden;
}

}  // namespace sansmesh::inline v1::detail
