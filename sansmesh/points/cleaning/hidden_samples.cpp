#include "sansmesh/points/cleaning/hidden_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "sansmesh/core/parallel.h"
#include "sansmesh/points/orientation/sign_parts.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1::detail {
namespace {

/// Neighbours in the plan view, and number of these above and in another sheet from which a sample is hidden.
constexpr std::size_t kPlanNeighbours = 48, kFewestAbove = 2;
/// Consecutive samples in the order of the tree, and stride of those that are looked at first.
constexpr std::size_t kRun = 128, kProbe = 8;
/// Least number of samples of a smooth patch that hides others: leaves do not.
constexpr std::uint32_t kFewestInCover = 200;
/// Largest relation of two upward normals of different sheets.
constexpr float kOtherSheet = -0.5f;
/// Height between the tangent planes of different sheets, in radii of the neighbourhood in the plan view.
constexpr float kApart = 3;
/// Samples of one sheet differ in height by up to this many noise levels.
constexpr double kThickness = 5;
/// Rounds in which the neighbours of hidden samples on their sheet become hidden: no cover is found above its rim.
constexpr int kRimRounds = 2;
/// Share of hidden samples from which all of a smooth patch is hidden.
constexpr double kHiddenPatch = 0.6;
/// Least number of samples of a hidden region. Ground beneath plants and eaves has smaller ones, and faces up.
constexpr std::uint32_t kFewestInRegion = 400;

/// Whether q is above p on another sheet. `n` and `m` are their upward normals. On one sheet these are mirror images in
/// the bisecting plane of the chord (as in RelationGraph), and tangent planes are close to the samples nearby.
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

SignForest smooth_patches(const RelationGraph& graph) {
  SignForest patches(graph.size());
  join_stretches(graph, patches, kSure[0]);
  for (const int sure : kSure) join_sure(graph, patches, sure);
  return patches;
}

/// Hides smooth patches that are mostly hidden.
void hide_patches(const SignForest& patches, std::span<const std::uint32_t> known, std::vector<std::uint8_t>& hidden) {
  std::vector<std::uint32_t> members(patches.size()), beneath(patches.size());
  for (const std::uint32_t s : known) {
    const std::uint32_t patch = patches.flat_root(s).index;
    ++members[patch], beneath[patch] += hidden[s];
  }
  for (const std::uint32_t s : known) {
    const std::uint32_t patch = patches.flat_root(s).index;
    if (static_cast<double>(beneath[patch]) > kHiddenPatch * static_cast<double>(members[patch])) hidden[s] = 1;
  }
}

/// Small hidden regions count as visible: they may be ground beneath plants, whose neighbours decide nothing.
void show_small_regions(const RelationGraph& graph, std::vector<std::uint8_t>& hidden) {
  std::vector<std::uint8_t> visible(graph.size());
  for (std::size_t s = 0; s < graph.size(); ++s) visible[s] = !hidden[s];
  SignForest regions(graph.size());
  join_sure(graph, regions, 0, visible);
  std::vector<std::uint32_t> members(graph.size());
  for (std::uint32_t s = 0; s < graph.size(); ++s) ++members[regions.flat_root(s).index];
  for (std::uint32_t s = 0; s < graph.size(); ++s)
    if (members[regions.flat_root(s).index] < kFewestInRegion) hidden[s] = 0;
}

}  // namespace

std::vector<std::uint8_t> find_hidden_from_above(const RelationGraph& graph) {
  const std::size_t n = graph.size();
  const SignForest patches = smooth_patches(graph);
  std::vector<std::uint32_t> members(n), known, covers;
  for (std::uint32_t s = 0; s < n; ++s) ++members[patches.flat_root(s).index];
  std::vector<Vec3f> plan;
  const auto in_plan = [&](std::uint32_t s) { return Vec3f{graph.positions()[s].x, graph.positions()[s].y, 0}; };
  for (std::uint32_t s = 0; s < n; ++s) {
    if (!(std::abs(graph.normals()[s].z) > kLeastSensorCosine) || !graph.firm(s)) continue;
    known.push_back(s);
    if (members[patches.flat_root(s).index] < kFewestInCover) continue;
    covers.push_back(s);
    plan.push_back(in_plan(s));
  }
  const KdTree tree(plan);
  const auto unseen = static_cast<float>(kThickness * graph.noise());
  const auto upward = [&](std::uint32_t s) {
    const Vec3f& normal = graph.normals()[s];
    return normal.z < 0 ? -normal : normal;
  };
  const auto count_above = [&](std::uint32_t s) {
    std::array<Neighbour, kPlanNeighbours> found;
    const std::size_t count = tree.nearest(in_plan(s), found);
    const float apart = count > 0 ? kApart * std::sqrt(found[count - 1].squared_distance) : 0;
    std::size_t above = 0;
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t q = covers[found[k].index];
      above += is_above(graph.positions()[s], upward(s), graph.positions()[q], upward(q), unseen, apart);
    }
    return above;
  };
  // Most regions have one sheet. Some samples of each run show which do; a region has many runs.
  std::vector<std::uint8_t> hidden(n);
  parallel_for(0, (known.size() + kRun - 1) / kRun, 4, [&](std::size_t run) {
    const auto samples = std::span(known).subspan(run * kRun, std::min(kRun, known.size() - run * kRun));
    bool any = false;
    for (std::size_t i = 0; i < samples.size() && !any; i += kProbe) any = count_above(samples[i]) > 0;
    for (std::size_t i = 0; i < samples.size() && any; ++i)
      hidden[samples[i]] = count_above(samples[i]) >= kFewestAbove;
  });
  for (int round = 0; round < kRimRounds; ++round) extend(graph, hidden);
  hide_patches(patches, known, hidden);
  show_small_regions(graph, hidden);
  return hidden;
}

}  // namespace sansmesh::inline v1::detail
