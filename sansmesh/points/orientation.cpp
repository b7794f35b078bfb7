#include "sansmesh/points/orientation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/points/noise.h"
#include "sansmesh/points/relation_graph.h"
#include "sansmesh/points/sign_graph.h"
#include "sansmesh/points/winding_doubt.h"
#include "sansmesh/points/winding_sides.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

using detail::RelationGraph, detail::join_stretches, detail::join_sure, detail::join_by_votes;

constexpr std::size_t kCheckSamples = 30000;
constexpr int kExtremeDirections = 64;
/// Cosines between normals and directions to the sensor: above the first, the sign is fixed at once; above the second,
/// after the smooth patches, where these are undecided.
constexpr float kClearSensorCosine = 0.5f, kLeastSensorCosine = 0.25f;
/// A direction is implausible if this share of the visible samples of smooth patches contradicts the rest of the patch.
constexpr double kMostContradiction = 0.2;
/// Number of samples sufficient for this test, and length of their stretches.
constexpr std::size_t kBelievedSamples = 100000, kStretchSamples = 4096;
/// Thresholds of edge reliability in the order of joining; down to the last one the patches are smooth.
constexpr int kSure[] = {118, 105, 90, 75};
/// Area vectors of a closed surface sum to zero; half a ball leaves half of its area, terrain nearly all. A part above
/// this share is open and has no outside.
constexpr double kOpenPart = 0.35;
/// Agreement of neighbours above which voting again is unnecessary.
constexpr double kHardlyContradicted = 0.999;
/// Signs are correct with the first agreement unless whole regions are reversed, which doubt above the second value
/// indicates; or with the third agreement and hardly any doubt. (48 noisy clouds of known shapes: see
/// docs/methods/points.md.)
constexpr double kNoContradiction = 0.9995, kMostDoubtOfSmooth = 0.25;
constexpr double kLittleContradiction = 0.9955, kMostDoubt = 0.05;
/// Voting patches: least number of adjacent samples in tree order per stretch, largest number of stretches, and largest
/// number of patches per stretch. Rough normals break a stretch into many patches; votes between more of them would be
/// slow and uninformative.
constexpr std::size_t kLeastPatch = 8, kMostStretches = 20000, kMostPatchesOfStretch = 4;

/// Winding numbers: number of samples that determine them, and that of small parts; least number of samples of a part;
/// weight of their direction against that of all neighbours; samples of a patch; rounds of single votes.
constexpr std::size_t kWindingNodes = 10000, kNodesOfSmall = 2000, kFewestOfWinding = 200, kLeastWindingPatch = 16;
constexpr double kOutwardWeight = 4;
constexpr int kWindingPolish = 4;
/// Relative variances of the winding number above which the signs of a closed part, or of a part that seems open, are
/// doubtful.
constexpr double kClosedError = 0.1, kSheetError = 0.3;
/// Signs of a closed part are replaced if the relative variance falls below the first factor, unless the contradictions
/// between neighbours exceed a share, a cut of this length (1: the edge of the square with the area of the part), or a
/// multiple of the former ones. Smooth open sheets have none before, and would be folded.
constexpr double kImproves = 0.985, kLeastTolerated = 0.004, kToleratedCut = 0.3, kTolerated = 8;
/// The multiple is larger if the relative variance falls from this value below this factor: one of two touching balls.
constexpr double kWrongError = 0.6, kCloses = 0.25, kToleratedByFar = 25;
/// Close sheets become the two sides of a plate below this relative variance, without longer cuts.
constexpr double kPlateError = 0.1, kLongestCut = 1;

/// Directions from the samples of a graph to the sensor, and an extra node that represents it: samples that agree with
/// this node face the sensor.
class SensorCosines {
 public:
  SensorCosines() = default;
  /// Rough parts have also been seen from the side and from within by an airborne sensor: only `firm` samples count.
  SensorCosines(const RelationGraph& graph, const std::vector<Vec3f>& directions, bool from_air)
      : cosine_(directions.empty() ? 0 : graph.size()) {
    parallel_for(0, cosine_.size(), 16384, [&](std::size_t s) {
      if (from_air && !graph.firm(s)) return;
      cosine_[s] = std::clamp(dot(graph.normals()[s], directions[graph.tree().order()[s]]), -1.0f, 1.0f);
    });
  }

  bool known() const { return !cosine_.empty(); }
  /// Cosine between normal and sensor direction; 0 if unknown.
  float cosine(std::size_t s) const { return cosine_[s]; }
  void join(SignForest& forest, float least) const {
    const auto anchor = static_cast<std::uint32_t>(cosine_.size());
    for (std::uint32_t s = 0; s < anchor; ++s)
      if (std::abs(cosine_[s]) > least) forest.join(s, anchor, cosine_[s] < 0);
  }

  /// Whether each smooth patch has been seen from one side. Large clouds are tested on some stretches in tree order.
  bool believable(const RelationGraph& graph) const {
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

 private:
  /// Next sample after s if one stretch in `skip` is tested.
  static std::size_t next_of_stretch(std::size_t s, std::size_t skip) {
    ++s;
    return s % kStretchSamples == 0 ? s + (skip - 1) * kStretchSamples : s;
  }

  std::vector<float> cosine_;
};

// Joins smooth patches first, from the most to the least reliable edges; then patches by the vote of all edges between
// them. Samples that clearly face the sensor or away are fixed before, the others after the patches.
void propagate(const RelationGraph& graph, const SensorCosines& sensor, SignForest& forest, Progress& progress) {
  if (sensor.known()) {
    sensor.join(forest, kClearSensorCosine);
    forest.flatten();
  } else {
    join_stretches(graph, forest, kSure[0]);
  }
  for (const int sure : kSure) {
    join_sure(graph, forest, sure);
    progress.advance(graph.size());
  }
  if (sensor.known()) sensor.join(forest, kLeastSensorCosine);
  forest.flatten();
  join_by_votes(graph, forest);
  progress.advance(graph.size());
}

/// Connected parts of the graph, and the sign of each sample that makes it agree with its part.
struct Parts {
  std::vector<std::uint32_t> part;  ///< part of each sample
  std::vector<std::int8_t> sign;
  std::size_t count = 0;
  /// Confidence that the signs make the part's normals point outward: negative = inward.
  std::vector<double> outwardness;
  /// Parts so far from closed that they have no outside.
  std::vector<std::uint8_t> open;
  /// Part whose samples have been seen from a known side, and the sign that makes them face it.
  std::optional<std::uint32_t> seen;
  std::int8_t seen_sign = 1;
};

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

// Flips individual samples that contradict most of their neighbours. The sensor direction weighs as much as all
// neighbours.
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

/// Number of sets of a flat forest.
std::size_t sets_of(const SignForest& forest) {
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < forest.size(); ++i) count += forest.flat_root(i).index == i;
  return count;
}

/// Determines the signs of a graph's normals. Noise can make even the most reliable edges contradictory, so that the
/// first ones decide for whole regions. Votes between small patches, unless there are too many, use all edges. Keeps
/// the result with fewer contradictions.
Parts settle_signs(const RelationGraph& graph, const SensorCosines& sensor, Progress& progress) {
  SignForest forest(graph.size() + 1);
  propagate(graph, sensor, forest, progress);
  Parts parts = collect_parts(graph, sensor, forest);
  polish(graph, sensor, parts);
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

// Points of a Fibonacci lattice on the sphere.
Vec3f direction(int i) {
  const double z = 1 - (2 * i + 1.0) / kExtremeDirections, r = std::sqrt(1 - z * z);
  const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
  return Vec3f(Vec3{r * std::cos(angle), r * std::sin(angle), z});
}

// Combines the enclosed volume, relative to its possible maximum, with the mean cosine between normals and the
// directions in which their samples are extremal. A part so flat that neither is significant (terrain) faces up. Skips
// the part with a known sensor.
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

/// Weighted share of the edges of a part that contradict its signs.
struct Contradictions {
  double all = 0;
  double sure = 0;  ///< the reliable edges among them, times `edge`: the length of cuts through smooth sheets
  double edge = 0;  ///< root of the number of samples
};

std::vector<Contradictions> contradictions(const RelationGraph& graph, const Parts& parts,
                                           std::span<const std::int8_t> sign) {
  std::vector<Contradictions> against(parts.count);
  std::vector<double> weight(parts.count), members(parts.count);
  for (std::size_t s = 0; s < graph.size(); ++s) {
    const std::uint32_t p = parts.part[s];
    ++members[p];
    for (std::size_t k = 0; k < graph.degree(); ++k) {
      const int r = graph.relation_to(s, k);
      const double w = static_cast<double>(r) * r;
      weight[p] += w;
      if (sign[s] != sign[graph.neighbour(s, k)] ? r <= 0 : r >= 0) continue;
      against[p].all += w;
      if (std::abs(r) >= kSure[1]) against[p].sure += w;
    }
  }
  for (std::size_t p = 0; p < parts.count; ++p) {
    against[p].edge = std::sqrt(members[p]);
    if (!(weight[p] > 0)) continue;
    against[p].all /= weight[p];
    against[p].sure *= against[p].edge / weight[p];
  }
  return against;
}

/// State of a part's signs.
struct Consistency {
  Contradictions neighbours;
  double error = 0;  ///< relative variance of the winding number
};

/// Part whose signs winding numbers may improve.
struct DoubtfulPart {
  std::uint32_t part;
  Consistency before;
  detail::WindingSides sides;
};

bool may_improve(bool open, const Consistency& now) {
  return open ? now.error > kSheetError : now.neighbours.all > 1 - kNoContradiction || now.error > kClosedError;
}

bool improves(bool open, bool close_sheets, const Consistency& before, const Consistency& then) {
  const Contradictions &now = before.neighbours, &later = then.neighbours;
  // Neighbours agree across a plate of two spacings.
  if (close_sheets && before.error > kSheetError && then.error < kPlateError && later.sure < kLongestCut) return true;
  if (open || then.error >= kImproves * before.error) return false;
  const bool by_far = before.error > kWrongError && then.error < kCloses * before.error;
  return later.all < std::max(std::min(kLeastTolerated, kToleratedCut / later.edge),
                              (by_far ? kToleratedByFar : kTolerated) * now.all);
}

/// Parts with contradictions between neighbours or in the winding number, the largest first, within a budget of nodes.
std::vector<DoubtfulPart> doubtful_parts(const RelationGraph& graph, const Parts& parts,
                                         std::span<const std::int8_t> sign,
                                         std::span<const Contradictions> neighbours) {
  std::vector<std::vector<std::uint32_t>> members(parts.count);
  for (std::size_t s = 0; s < graph.size(); ++s) members[parts.part[s]].push_back(static_cast<std::uint32_t>(s));
  std::vector<std::uint32_t> order;
  for (std::uint32_t p = 0; p < parts.count; ++p)
    if (members[p].size() >= kFewestOfWinding) order.push_back(p);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return members[a].size() != members[b].size() ? members[a].size() > members[b].size() : a < b;
  });
  const std::size_t step = (graph.size() + kWindingNodes - 1) / kWindingNodes;
  std::size_t nodes = 0;
  std::vector<DoubtfulPart> doubtful;
  for (const std::uint32_t p : order) {
    // Small parts have more nodes, so that their shape is known.
    const std::size_t own_step = std::clamp<std::size_t>(members[p].size() / kNodesOfSmall, 1, step);
    nodes += members[p].size() / own_step;
    if (nodes > 2 * kWindingNodes) break;
    detail::WindingSides sides(graph, members[p], own_step);
    const Consistency now{neighbours[p], sides.error(sign)};
    if (may_improve(parts.open[p] != 0, now)) doubtful.push_back({p, now, std::move(sides)});
  }
  return doubtful;
}

/// Replaces the signs of parts by signs with consistent winding numbers where these contradict themselves less. Small
/// patches, their neighbours' votes, and the directions of the winding numbers decide together.
void settle_by_winding(const RelationGraph& graph, Parts& parts) {
  const std::size_t n = graph.size();
  std::vector<std::int8_t> before(n);
  for (std::size_t s = 0; s < n; ++s)
    before[s] = static_cast<std::int8_t>(parts.outwardness[parts.part[s]] < 0 ? -parts.sign[s] : parts.sign[s]);
  const std::vector<DoubtfulPart> doubtful = doubtful_parts(graph, parts, before, contradictions(graph, parts, before));
  if (doubtful.empty()) return;

  // A further node for each part represents its outside.
  SignForest forest(n + parts.count);
  join_stretches(graph, forest, kSure[0], std::max(kLeastWindingPatch, n / kMostStretches));
  if (sets_of(forest) > kMostPatchesOfStretch * kMostStretches + parts.count) return;
  const double weight = kOutwardWeight * 127 * 127 * static_cast<double>(graph.degree());
  std::vector<std::int64_t> outward_vote(n);
  std::vector<std::uint8_t> asked(parts.count);
  std::vector<SignVote> votes;
  for (const DoubtfulPart& of : doubtful) {
    asked[of.part] = 1;
    const std::vector<Vec3f> outward = of.sides.outward();
    for (std::size_t i = 0; i < outward.size(); ++i) {
      const std::uint32_t s = of.sides.nodes()[i];
      const double cosine = static_cast<double>(std::clamp(dot(graph.normals()[s], outward[i]), -1.0f, 1.0f));
      outward_vote[s] = whole_part<std::int64_t>(std::round(weight * cosine * std::abs(cosine)));
      if (outward_vote[s] != 0) votes.push_back({s, static_cast<std::uint32_t>(n + of.part), outward_vote[s]});
    }
  }
  join_by_votes(graph, forest, std::move(votes));
  std::vector<std::int8_t> sign = before;
  for (std::uint32_t s = 0; s < n; ++s) {
    if (!asked[parts.part[s]]) continue;
    const bool inward = forest.find(s).flip != forest.find(static_cast<std::uint32_t>(n + parts.part[s])).flip;
    sign[s] = inward ? -1 : 1;
  }
  for (int round = 0; round < kWindingPolish; ++round) {
    const std::vector<std::int8_t> last = sign;
    parallel_for(0, n, 8192, [&](std::size_t s) {
      if (!asked[parts.part[s]]) return;
      std::int64_t vote = outward_vote[s];
      for (std::size_t k = 0; k < graph.degree(); ++k) {
        const std::int64_t r = graph.relation_to(s, k);
        vote += r * std::abs(r) * last[graph.neighbour(s, k)];
      }
      if (vote * last[s] < 0) sign[s] = static_cast<std::int8_t>(-last[s]);
    });
  }
  const std::vector<Contradictions> neighbours = contradictions(graph, parts, sign);
  for (const DoubtfulPart& of : doubtful) {
    const std::uint32_t p = of.part;
    asked[p] = improves(parts.open[p] != 0, graph.has_close_sheets(), of.before, {neighbours[p], of.sides.error(sign)});
    if (asked[p]) parts.outwardness[p] = 1, parts.open[p] = 0;
  }
  for (std::size_t s = 0; s < n; ++s)
    if (asked[parts.part[s]]) parts.sign[s] = sign[s];
}

std::string unknown_source(OrientBy asked) {
  switch (asked) {
    case OrientBy::scanner:
      return "has no scanner positions for orienting normals";
    case OrientBy::rows:
      return "has no rows and columns for orienting normals";
    case OrientBy::flight:
      return "has no scan angles of flight lines for orienting normals";
    default:
      return "has no data for orienting normals";
  }
}

// Compares the given normals with reoriented ones.
OrientationReport judge(std::span<const Vec3f> positions, std::span<const Vec3f> normals, double noise,
                        bool with_doubt) {
  Progress silent;
  const KdTree tree(positions);
  const RelationGraph graph(tree, normals, 10, noise);
  SignForest forest(graph.size());
  const SensorCosines unknown;
  propagate(graph, unknown, forest, silent);
  Parts parts = collect_parts(graph, unknown, forest);
  polish(graph, unknown, parts);
  judge_outwardness(graph, parts);

  // In each part the majority of the given signs counts as given; the others had to be flipped.
  std::vector<std::size_t> members(parts.count), negative(parts.count);
  for (std::size_t s = 0; s < graph.size(); ++s) {
    ++members[parts.part[s]];
    negative[parts.part[s]] += parts.sign[s] < 0;
  }
  std::size_t flipped = 0, inward = 0, open = 0;
  for (std::size_t p = 0; p < parts.count; ++p) {
    if (parts.open[p]) open += members[p];
    const bool turned = 2 * negative[p] > members[p];
    flipped += turned ? members[p] - negative[p] : negative[p];
    if (!parts.open[p] && (turned ? -parts.outwardness[p] : parts.outwardness[p]) < -0.2) inward += members[p];
  }
  // Where flipped and unflipped samples meet, the given normals must have contradicted each other; otherwise the flip
  // was arbitrary, as between the sides of a thin sheet.
  double contradiction = 0, agreement = 0;
  for (std::size_t s = 0; s < graph.size(); ++s)
    for (std::size_t k = 0; k < graph.degree(); ++k) {
      const double r = graph.relation_to(s, k);
      if (parts.sign[s] == parts.sign[graph.neighbour(s, k)]) continue;
      (r < 0 ? contradiction : agreement) += r * r;
    }
  const bool systematic = contradiction > 3 * agreement;
  OrientationReport report;
  const auto all = static_cast<double>(graph.size());
  report.agreement = graph.agreement();
  if (with_doubt) report.doubt = detail::winding_doubt(graph, parts.part, parts.open, noise);
  std::size_t firm = 0;
  for (std::size_t s = 0; s < graph.size(); ++s) firm += graph.firm(s);
  report.related = static_cast<double>(firm) / all;
  report.inward = static_cast<double>(inward) / all;
  report.open = static_cast<double>(open) / all;
  report.outward = std::max(0.0, 1 - report.inward - report.open);
  report.check = 2 * inward > graph.size() ? OrientationCheck::inward : OrientationCheck::oriented;
  if ((static_cast<double>(flipped) > 0.06 * all && systematic) || report.agreement < kLeastAgreement ||
      report.related < kLeastRelated)
    report.check = OrientationCheck::unoriented;
  return report;
}

/// Judges a subset distributed over all points.
OrientationReport judge_some(const PointSet& points, std::optional<double> known_noise, bool with_doubt) {
  if (points.normals.size() != points.size()) return {};
  std::vector<Vec3f> positions, normals;
  std::size_t with_normal = 0;
  for (const Vec3f& n : points.normals) with_normal += squared_norm(n) > 0.25f;
  if (with_normal * 10 < points.size() || with_normal == 0) return {};
  // Equal steps through the samples with normals.
  const std::size_t wanted = std::min(with_normal, kCheckSamples);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!(squared_norm(points.normals[i]) > 0.25f)) continue;
    const std::size_t index = seen++;
    if ((index + 1) * wanted / with_normal == index * wanted / with_normal || !is_finite(points.positions[i])) continue;
    positions.push_back(points.positions[i]);
    normals.push_back(points.normals[i]);
  }
  if (positions.empty()) return {};
  const double noise = known_noise ? *known_noise : estimate_noise(points);
  const OrientationReport judgement = judge(positions, normals, noise, with_doubt);
  // The sides of a thin sheet may have been mistaken for noise.
  if (judgement.check != OrientationCheck::unoriented || noise == 0) return judgement;
  return judge(positions, normals, 0, with_doubt);
}

bool from_air(OrientBy by) { return by == OrientBy::flight || by == OrientBy::up; }

/// Requested source, or the first known and plausible one in order of reliability.
OrientBy choose_source(const PointSet& points, const RelationGraph& graph, OrientBy asked, double noise,
                       SensorCosines& sensor) {
  if (asked == OrientBy::propagation) return asked;
  if (asked != OrientBy::automatic) {
    const std::vector<Vec3f> found = find_sensor_directions(points, asked);
    if (found.empty()) throw DataError(unknown_source(asked));
    sensor = SensorCosines(graph, found, from_air(asked));
    return asked;
  }
  for (const OrientBy by : kOrientationOrder) {
    const std::vector<Vec3f> found = find_own_sensor_directions(points, by, noise);
    if (found.empty()) continue;
    sensor = SensorCosines(graph, found, from_air(by));
    if (sensor.believable(graph)) return by;
  }
  sensor = {};
  return OrientBy::propagation;
}

}  // namespace

void OrientationOptions::validate() const { check_range("neighbours", neighbours, 4, 100); }

OrientBy orient_normals(PointSet& points, const OrientationOptions& options, Progress& progress) {
  return orient_normals(points, KdTree(points.positions), options, progress);
}

OrientBy orient_normals(PointSet& points, const KdTree& tree, const OrientationOptions& options, Progress& progress) {
  options.validate();
  if (points.normals.size() != points.size() || points.size() == 0)
    throw DataError("there are no normals to orient: estimate them first");
  progress.begin("orientation", 6 * points.size());
  const double noise = options.noise ? *options.noise : estimate_noise(points);
  const RelationGraph graph(tree, points.normals, options.neighbours, noise);
  progress.advance(points.size());
  SensorCosines sensor;
  const OrientBy by = choose_source(points, graph, options.by, noise, sensor);
  Parts parts = settle_signs(graph, sensor, progress);
  judge_outwardness(graph, parts);
  if (!sensor.known()) settle_by_winding(graph, parts);
  parallel_for(0, graph.size(), 16384, [&](std::size_t s) {
    const std::uint32_t p = parts.part[s];
    bool flip = (parts.sign[s] < 0) != (parts.outwardness[p] < 0);
    if (parts.seen && p == *parts.seen) flip = (parts.sign[s] < 0) != (parts.seen_sign < 0);
    if (flip) points.normals[graph.tree().order()[s]] = -graph.normals()[s];
  });
  progress.finish();
  return by;
}

double share_facing_away(const PointSet& points, std::span<const Vec3f> directions) {
  std::size_t away = 0, clear = 0;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const float cosine = dot(points.normals[i], directions[i]);
    clear += std::abs(cosine) > kLeastSensorCosine;
    away += cosine < -kLeastSensorCosine;
  }
  return clear > 0 ? static_cast<double>(away) / static_cast<double>(clear) : 0;
}

bool OrientationReport::certain() const {
  return agreement >= kNoContradiction ? doubt <= kMostDoubtOfSmooth
                                       : agreement >= kLittleContradiction && doubt <= kMostDoubt;
}

OrientationCheck check_orientation(const PointSet& points, std::optional<double> known_noise) {
  return judge_some(points, known_noise, false).check;
}

OrientationReport measure_orientation(const PointSet& points, std::optional<double> known_noise) {
  return judge_some(points, known_noise, true);
}

}  // namespace sansmesh::inline v1
