#include "sansmesh/points/orientation/sign_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <utility>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1::detail {
namespace {

constexpr int kExtremeDirections = 64;
/// Cosine between normal and direction to the sensor above which the sign is fixed at once; above `kLeastSensorCosine`,
/// after the smooth patches, where these are undecided.
constexpr float kClearSensorCosine = 0.5f;
/// A direction is implausible if this share of the visible samples of smooth patches contradicts the rest of the patch.
constexpr double kMostContradiction = 0.2;
/// Number of samples sufficient for this test, and length of their stretches.
constexpr std::size_t kBelievedSamples = 100000, kStretchSamples = 4096;
/// Area vectors of a closed surface sum to zero; half a ball leaves half of its area, terrain nearly all. A part above
/// this share is open and has no outside.
constexpr double kOpenPart = 0.35;
/// Agreement of neighbours above which voting again is unnecessary.
constexpr double kHardlyContradicted = 0.999;
/// Least number of adjacent samples in tree order per stretch of voting patches.
constexpr std::size_t kLeastPatch = 8;

/// Next sample after s if one stretch in `skip` is tested.
std::size_t next_of_stretch(std::size_t s, std::size_t skip) {
  ++s;
  return s % kStretchSamples == 0 ? s + (skip - 1) * kStretchSamples : s;
}

// Points of a Fibonacci lattice on the sphere.
Vec3f direction(int i) {
  const double z = 1 - (2 * i + 1.0) / kExtremeDirections, r = std::sqrt(1 - z * z);
  const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
  return Vec3f(Vec3{r * std::cos(angle), r * std::sin(angle), z});
}

}  // namespace

SensorCosines::SensorCosines(const RelationGraph& graph, const std::vector<Vec3f>& directions, bool from_air)
    : cosine_(directions.empty() ? 0 : graph.size()) {
  parallel_for(0, cosine_.size(), 16384, [&](std::size_t s) {
    if (from_air && !graph.firm(s)) return;
    cosine_[s] = std::clamp(dot(graph.normals()[s], directions[graph.tree().order()[s]]), -1.0f, 1.0f);
  });
}

void SensorCosines::join(SignForest& forest, float least) const {
  const auto anchor = static_cast<std::uint32_t>(cosine_.size());
  for (std::uint32_t s = 0; s < anchor; ++s)
    if (std::abs(cosine_[s]) > least) forest.join(s, anchor, cosine_[s] < 0);
}

void SensorCosines::forget(std::vector<std::uint8_t> hidden) {
  if (std::find(hidden.begin(), hidden.end(), std::uint8_t{1}) == hidden.end()) return;
  for (std::size_t s = 0; s < cosine_.size(); ++s)
    if (hidden[s]) cosine_[s] = 0;
  hidden_ = std::move(hidden);
}

bool SensorCosines::believable(const RelationGraph& graph) const {
  const std::size_t skip = 1 + graph.size() / kBelievedSamples, n = graph.size();
  const auto looked_at = [&](std::size_t s) { return s / kStretchSamples % skip == 0; };
  SignForest forest(n);
  for (const int sure : kSure)
    for (std::size_t s = 0; s < n; s = next_of_stretch(s, skip))
      for (std::size_t k = 0; k < graph.degree(); ++k) {
        const std::uint32_t q = graph.neighbour(s, k);
        const int r = graph.relation_to(s, k);
        if (std::abs(r) >= sure && looked_at(q)) forest.join(static_cast<std::uint32_t>(s), q, r < 0);
      }
  std::vector<double> agree(n), differ(n);
  for (std::size_t s = 0; s < n; s = next_of_stretch(s, skip)) {
    if (!(std::abs(cosine_[s]) > kLeastSensorCosine)) continue;
    const SignForest::Root root = forest.find(static_cast<std::uint32_t>(s));
    const double weight = static_cast<double>(cosine_[s]) * static_cast<double>(cosine_[s]);
    ((cosine_[s] < 0) != root.flip ? differ : agree)[root.index] += weight;
  }
  double contradiction = 0, all = 0;
  for (std::size_t s = 0; s < n; ++s) contradiction += std::min(agree[s], differ[s]), all += agree[s] + differ[s];
  return all > 0 && contradiction <= kMostContradiction * all;
}

void propagate(const RelationGraph& graph, const SensorCosines& sensor, SignForest& forest, Progress& progress) {
  if (sensor.known()) {
    // Reliable edges cross the wedge where an object touches the ground: a single one must not decide.
    if (!sensor.hidden().empty()) join_stretches(graph, forest, kSure[0], kLeastPatch, sensor.hidden());
    sensor.join(forest, kClearSensorCosine);
    forest.flatten();
  } else {
    join_stretches(graph, forest, kSure[0]);
  }
  for (const int sure : kSure) {
    join_sure(graph, forest, sure, sensor.hidden());
    progress.advance(graph.size());
  }
  if (sensor.known()) sensor.join(forest, kLeastSensorCosine);
  forest.flatten();
  join_by_votes(graph, forest);
  progress.advance(graph.size());
}

Parts collect_parts(const RelationGraph& graph, const SensorCosines& sensor, SignForest& forest) {
  Parts parts;
  constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> name(forest.size(), kNone);
  parts.part.resize(graph.size());
  parts.sign.resize(graph.size());
  for (std::size_t s = 0; s < graph.size(); ++s) {
    const SignForest::Root root = forest.find(static_cast<std::uint32_t>(s));
    if (name[root.index] == kNone) name[root.index] = static_cast<std::uint32_t>(parts.count++);
    parts.part[s] = name[root.index];
    parts.sign[s] = root.flip ? -1 : 1;
  }
  if (sensor.known()) {
    // The node may have no samples: all seen at a grazing angle, or by nonexistent scanners.
    const SignForest::Root root = forest.find(static_cast<std::uint32_t>(graph.size()));
    if (name[root.index] != kNone) parts.seen = name[root.index], parts.seen_sign = root.flip ? -1 : 1;
  }
  return parts;
}

void polish(const RelationGraph& graph, const SensorCosines& sensor, Parts& parts) {
  const float weight = 2.0f * 127 * 127 * static_cast<float>(graph.degree()) * parts.seen_sign;
  for (int round = 0; round < 2; ++round) {
    const std::vector<std::int8_t> before = parts.sign;
    parallel_for(0, graph.size(), 8192, [&](std::size_t s) {
      long vote = 0;
      for (std::size_t k = 0; k < graph.degree(); ++k) {
        const long r = graph.relation_to(s, k);
        vote += r * std::abs(r) * before[graph.neighbour(s, k)];
      }
      if (parts.seen && *parts.seen == parts.part[s])
        vote += whole_part<long>(std::round(weight * sensor.cosine(s) * std::abs(sensor.cosine(s))));
      if (vote * before[s] < 0) parts.sign[s] = static_cast<std::int8_t>(-before[s]);
    });
  }
}

std::size_t sets_of(const SignForest& forest) {
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < forest.size(); ++i) count += forest.flat_root(i).index == i;
  return count;
}

namespace {

/// Least number of samples of a coherent hidden group that is the underside of an object.
constexpr std::uint32_t kFewestOfUnderside = 400;

/// Turns small hidden groups up, unless they border on a large one: they are ground among plants.
void turn_small_groups(const RelationGraph& graph, const std::vector<std::uint8_t>& hidden, Parts& parts) {
  SignForest groups(graph.size());
  const auto coherent = [&](std::size_t s, std::size_t k) {
    const std::uint32_t q = graph.neighbour(s, k);
    const int r = graph.relation_to(s, k);
    return hidden[s] && hidden[q] && std::abs(r) >= kSure[3] && (r < 0) == (parts.sign[s] != parts.sign[q]);
  };
  visit_edges(graph, coherent,
              [&](const RelationEdge& e) { groups.join(e.sample, graph.neighbour(e.sample, e.rank), false); });
  groups.flatten();
  std::vector<std::uint32_t> members(graph.size());
  for (std::uint32_t s = 0; s < graph.size(); ++s) ++members[groups.flat_root(s).index];
  const auto is_large = [&](std::uint32_t s) { return members[groups.flat_root(s).index] >= kFewestOfUnderside; };
  std::vector<std::uint8_t> keeps(graph.size());  // by group
  for (std::uint32_t s = 0; s < graph.size(); ++s)
    for (std::size_t k = 0; k < graph.degree() && hidden[s]; ++k)
      if (is_large(s) || is_large(graph.neighbour(s, k))) keeps[groups.flat_root(s).index] = 1;
  for (std::uint32_t s = 0; s < graph.size(); ++s) {
    if (!hidden[s] || parts.part[s] != *parts.seen || keeps[groups.flat_root(s).index]) continue;
    const float z = graph.normals()[s].z;
    if (std::abs(z) > kClearSensorCosine && graph.firm(s))
      parts.sign[s] = static_cast<std::int8_t>(z < 0 ? -parts.seen_sign : parts.seen_sign);
  }
}

}  // namespace

Parts propagated_parts(const RelationGraph& graph, const SensorCosines& sensor, Progress& progress) {
  SignForest forest(graph.size() + 1);
  propagate(graph, sensor, forest, progress);
  Parts parts = collect_parts(graph, sensor, forest);
  polish(graph, sensor, parts);
  return parts;
}

Parts settle_signs(const RelationGraph& graph, const SensorCosines& sensor, Progress& progress) {
  Parts parts = propagated_parts(graph, sensor, progress);
  if (parts.seen && !sensor.hidden().empty()) turn_small_groups(graph, sensor.hidden(), parts);
  if (sensor.known()) return parts;
  const double agreement = graph.agreement(parts.sign);
  if (agreement >= kHardlyContradicted) return parts;
  SignForest patches(graph.size() + 1);
  join_stretches(graph, patches, kSure[0], std::max(kLeastPatch, graph.size() / kMostStretches));
  if (sets_of(patches) > kMostPatchesOfStretch * kMostStretches) return parts;
  join_by_votes(graph, patches);
  Parts voted = collect_parts(graph, sensor, patches);
  polish(graph, sensor, voted);
  return graph.agreement(voted.sign) > agreement ? voted : parts;
}

void judge_outwardness(const RelationGraph& graph, Parts& parts) {
  parts.outwardness.assign(parts.count, 0);
  parts.open.assign(parts.count, 0);
  std::vector<std::uint32_t> asked;
  for (std::size_t s = 0; s < graph.size(); ++s)
    if (!parts.seen || parts.part[s] != *parts.seen) asked.push_back(static_cast<std::uint32_t>(s));
  std::vector<Vec3> center(parts.count), up(parts.count);
  std::vector<double> area(parts.count), flux(parts.count), reach(parts.count), extremal(parts.count);
  for (const std::uint32_t s : asked) {
    const double a = graph.area()[s];
    center[parts.part[s]] += Vec3(graph.positions()[s]) * a;
    area[parts.part[s]] += a;
  }
  for (std::size_t p = 0; p < parts.count; ++p)
    if (area[p] > 0) center[p] = center[p] / area[p];
  for (const std::uint32_t s : asked) {
    const std::uint32_t p = parts.part[s];
    const Vec3 arm = Vec3(graph.positions()[s]) - center[p];
    const Vec3 normal = Vec3(graph.normals()[s]) * static_cast<double>(parts.sign[s]);
    const double a = graph.area()[s];
    flux[p] += a * dot(arm, normal);
    reach[p] += a * norm(arm) * norm(normal);
    up[p] += normal * a;
  }
  constexpr float kNowhere = std::numeric_limits<float>::lowest();
  std::vector<std::vector<float>> cosines(kExtremeDirections);
  parallel_for(0, cosines.size(), 1, [&](std::size_t i) {
    const Vec3f d = direction(static_cast<int>(i));
    std::vector<std::uint32_t> farthest(parts.count);
    std::vector<float> distance(parts.count, kNowhere);
    for (const std::uint32_t s : asked) {
      const float t = dot(graph.positions()[s], d);
      if (t > distance[parts.part[s]] &&
          graph.firm(s))  // stray samples are extremal, but their normals are meaningless
        distance[parts.part[s]] = t, farthest[parts.part[s]] = s;
    }
    cosines[i].resize(parts.count);
    for (std::size_t p = 0; p < parts.count; ++p)
      if (distance[p] > kNowhere)
        cosines[i][p] = dot(graph.normals()[farthest[p]], d) * static_cast<float>(parts.sign[farthest[p]]);
  });
  for (const std::vector<float>& of_parts : cosines)
    for (std::size_t p = 0; p < parts.count; ++p) extremal[p] += static_cast<double>(of_parts[p]) / kExtremeDirections;
  for (std::size_t p = 0; p < parts.count; ++p) {
    double score = extremal[p] + (reach[p] > 0 ? flux[p] / reach[p] : 0);
    if (std::abs(score) < 0.25 && std::abs(up[p].z) > 0.5 * area[p]) score = std::copysign(0.01, up[p].z);
    parts.outwardness[p] = score;
    parts.open[p] = norm(up[p]) > kOpenPart * area[p];
  }
}

}  // namespace sansmesh::inline v1::detail
