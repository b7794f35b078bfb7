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
#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/points/noise.h"
#include "sansmesh/points/sign_graph.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh {
namespace {

constexpr std::size_t kCheckSamples = 30000;
constexpr int kExtremeDirections = 64;
/// Cosines between normals and the way to where their samples were seen from: beyond the first one the sign is taken
/// from it at once, beyond the second one where the smooth patches say nothing.
constexpr float kClearSight = 0.5f, kLeastSight = 0.25f;
/// Where so much of what smooth patches see contradicts the rest of the patch, it was not seen from there.
constexpr double kMostContradiction = 0.2;
/// About so many samples are enough to see that, in stretches of so many.
constexpr std::size_t kBelievedSamples = 100000, kStretchSamples = 4096;
/// The surest relations, joined in this order; with the last one the patches are still smooth.
constexpr int kSure[] = {118, 105, 90, 75};
/// Area vectors of a closed surface sum to zero; half a ball leaves half of its area, terrain nearly all. Above this
/// share a part is open, and has no outside.
constexpr double kOpenPart = 0.35;
/// Heights of so many noises are not seen: between sheets that are near each other fewer must do, since a single
/// relation across would join them.
constexpr double kUnseen = 3, kUnseenWithin = 2;
/// Edges are looked at in stretches of so many samples, which threads share out.
constexpr std::size_t kEdgeSamples = 32768;
/// From about so many samples the noise within sheets is estimated, so many next to each other. Above the first of
/// these (in spacings) it can be told from what the shape leaves; above the second one the nearest neighbours are no
/// longer those along the surface. Noise that is said to be so much less or so much more is not believed.
constexpr std::size_t kSheetSamples = 5000, kSheetStretch = 16;
constexpr double kCertainNear = 0.15, kLargestNear = 0.45;
constexpr double kHiddenNoise = 0.67, kSheetsAsNoise = 1.5, kSheetsWithoutNoise = 2.5;
/// Mean size of the relations of a sample (of 127) below which its normal says little: a stray, or leaves.
constexpr int kFirm = 30;
/// No sample stands for more than so many times the area that its neighbours do: strays would.
constexpr float kLargestArea = 4;

/// How the sign of the normals at both ends of an edge relate: near +1 surely equal, near -1 surely opposite, near 0
/// unknown. The normals at the ends of an arc mirror each other in the chord's bisecting plane, whether the arc is
/// flat, round or a crease (König & Gumhold 2009). Edges that climb out of both tangent planes alike join two sheets:
/// these say nothing. Heights below `unseen` count as zero, or noise would look like many sheets.
float relation(const Vec3f& p, const Vec3f& n, const Vec3f& q, const Vec3f& m, float unseen) {
  const Vec3f d = q - p;
  const float length = norm(d);
  const float cosine = dot(n, m);
  if (!(length > 0)) return cosine;
  const auto slope = [&](const Vec3f& normal) {
    const float height = dot(normal, d);
    return std::copysign(std::max(0.0f, std::abs(height) - unseen), height) / length;
  };
  const float a = slope(n), b = slope(m);
  const float mirrored = cosine - 2 * a * b;
  const float climb = std::abs(mirrored < 0 ? a - b : a + b);
  return mirrored * std::max(0.0f, 1 - std::max(std::abs(a), std::abs(b))) * std::max(0.0f, 1 - 2 * climb);
}

std::int8_t quantized(float relation_value) {
  return static_cast<std::int8_t>(std::lround(std::clamp(relation_value, -1.0f, 1.0f) * 127));
}

/// The neighbour graph in tree order, and what its edges say.
class RelationGraph {
 public:
  /// The tree of the samples' positions stays where it is.
  RelationGraph(const KdTree& tree, std::span<const Vec3f> normals, int neighbours, double noise)
      : tree_(tree), degree_(static_cast<std::size_t>(neighbours)) {
    const std::size_t n = tree_.size();
    positions_ = tree_.positions();
    normals_.resize(n);
    area_.resize(n);
    neighbours_.resize(n * degree_);
    relations_.resize(n * degree_);
    parallel_for(0, n, 16384, [&](std::size_t s) { normals_[s] = normals[tree_.order()[s]]; });
    const double within = within_sheet(noise);
    const auto unseen = static_cast<float>(within == noise ? kUnseen * noise : kUnseenWithin * within);
    tree_.for_each_nearest(degree_ + 1, [&](std::uint32_t s, std::span<const Neighbour> found) {
      std::size_t count = 0;
      for (const Neighbour& neighbour : found) {
        if (neighbour.index == s || count == degree_) continue;
        neighbours_[s * degree_ + count] = neighbour.index;
        relations_[s * degree_ + count++] = quantized(
            relation(positions_[s], normals_[s], positions_[neighbour.index], normals_[neighbour.index], unseen));
      }
      for (; count < degree_; ++count) neighbours_[s * degree_ + count] = s;  // a loop: says nothing
      area_[s] = found.back().squared_distance;
    });
    limit_areas();
  }

  std::size_t size() const { return positions_.size(); }
  std::size_t degree() const { return degree_; }
  std::uint32_t neighbour(std::size_t s, std::size_t k) const { return neighbours_[s * degree_ + k]; }
  int relation_to(std::size_t s, std::size_t k) const { return relations_[s * degree_ + k]; }
  /// Whether the sample's normal has to do with those of its neighbours.
  bool firm(std::size_t s) const {
    int sure = 0;
    for (std::size_t k = 0; k < degree_; ++k) sure += std::abs(relation_to(s, k));
    return sure >= kFirm * static_cast<int>(degree_) && squared_norm(normals_[s]) > 0;
  }
  const KdTree& tree() const { return tree_; }
  const std::vector<Vec3f>& positions() const { return positions_; }
  const std::vector<Vec3f>& normals() const { return normals_; }
  const std::vector<float>& area() const { return area_; }  ///< up to a common factor

 private:
  /// `noise`, or what the nearest neighbours say of it where that is something else: two sheets that are a few spacings
  /// apart look like noise in wide neighbourhoods, or hide the noise that each of them has. How far neighbours lie off
  /// the mean of their tangent planes is noise; what the shape does to it has the other sign at the other end.
  double within_sheet(double noise) const {
    std::vector<float> off, reach;
    const auto look = [&](std::uint32_t s, std::span<const Neighbour> found) {
      reach.push_back(found.back().squared_distance);
      for (const Neighbour& neighbour : found) {
        const std::uint32_t q = neighbour.index;
        if (q == s) continue;
        const Vec3f d = positions_[q] - positions_[s];
        const float same = dot(normals_[s], normals_[q]) < 0 ? -1.0f : 1.0f;
        off.push_back(std::abs(dot(normals_[s] + normals_[q] * same, d)) * 0.5f);
      }
    };
    const std::size_t step = kSheetStretch * (1 + size() / kSheetSamples);
    for (std::size_t s = 0; s < size(); s += step)
      tree_.for_each_nearest(degree_ + 1, s, std::min(s + kSheetStretch, size()), look);
    if (off.empty()) return noise;
    const double spacing =
        std::sqrt(std::numbers::pi * static_cast<double>(median(reach)) / static_cast<double>(degree_));
    // Normal deviates: differences of two are √2 wide, and half of them are within 0.67 of that.
    const double near = static_cast<double>(median(off)) / (0.6745 * std::numbers::sqrt2);
    const bool certain = near > kCertainNear * spacing;
    const bool hidden = certain && noise < kHiddenNoise * near;
    const bool sheets = noise > (certain ? kSheetsAsNoise : kSheetsWithoutNoise) * near;
    return near < kLargestNear * spacing && (hidden || sheets) ? near : noise;
  }

  void limit_areas() {
    std::vector<float> some;
    for (std::size_t s = 0; s < size(); s += 1 + size() / kSheetSamples) some.push_back(area_[s]);
    if (some.empty()) return;
    const float large = kLargestArea * median(some);
    const std::vector<float> raw = area_;
    parallel_for(0, size(), 8192, [&](std::size_t s) {
      if (raw[s] <= large) return;  // as most are
      std::vector<float> around(degree_);
      for (std::size_t k = 0; k < degree_; ++k) around[k] = raw[neighbour(s, k)];
      area_[s] = std::min(raw[s], kLargestArea * median(around));
    });
  }

  const KdTree& tree_;
  std::size_t degree_;
  std::vector<Vec3f> positions_, normals_;
  std::vector<float> area_;
  std::vector<std::uint32_t> neighbours_;
  std::vector<std::int8_t> relations_;
};

/// An edge of the graph by the sample that it belongs to and its rank there.
struct Edge {
  std::uint32_t sample, rank;
};

/// Calls visit(edge) for those for which keep(sample, rank) is true, in their order; all are asked before.
template <class Keep, class Visit>
void visit_edges(const RelationGraph& graph, const Keep& keep, const Visit& visit) {
  std::vector<std::vector<Edge>> kept((graph.size() + kEdgeSamples - 1) / kEdgeSamples);
  parallel_for(0, kept.size(), 1, [&](std::size_t c) {
    const std::size_t last = std::min(graph.size(), (c + 1) * kEdgeSamples);
    for (std::size_t s = c * kEdgeSamples; s < last; ++s)
      for (std::size_t k = 0; k < graph.degree(); ++k)
        if (keep(s, k)) kept[c].push_back({static_cast<std::uint32_t>(s), static_cast<std::uint32_t>(k)});
  });
  for (std::vector<Edge>& some : kept)
    for (const Edge& e : std::exchange(some, {})) visit(e);
}

/// Joins along the edges at least so sure within stretches of the tree, each by itself, in a forest of single samples.
void join_stretches(const RelationGraph& graph, SignForest& forest, int sure) {
  parallel_for(0, (graph.size() + kEdgeSamples - 1) / kEdgeSamples, 1, [&](std::size_t c) {
    const std::size_t first = c * kEdgeSamples, last = std::min(graph.size(), first + kEdgeSamples);
    for (std::size_t s = first; s < last; ++s)
      for (std::size_t k = 0; k < graph.degree(); ++k) {
        const int r = graph.relation_to(s, k);
        const std::uint32_t q = graph.neighbour(s, k);
        if (std::abs(r) >= sure && q >= first && q < last) forest.join(static_cast<std::uint32_t>(s), q, r < 0);
      }
  });
  forest.flatten();
}

/// Joins along all edges at least so sure; the forest is flat before and after. Most of them join what belongs together
/// already, which all threads see at once.
void join_sure(const RelationGraph& graph, SignForest& forest, int sure) {
  const auto joins = [&](std::size_t s, std::size_t k) {
    return std::abs(graph.relation_to(s, k)) >= sure &&
           forest.flat_root(static_cast<std::uint32_t>(s)).index != forest.flat_root(graph.neighbour(s, k)).index;
  };
  visit_edges(graph, joins, [&](const Edge& e) {
    forest.join(e.sample, graph.neighbour(e.sample, e.rank), graph.relation_to(e.sample, e.rank) < 0);
  });
  forest.flatten();
}

/// The way to where each sample of a graph was seen from, and the node behind all others that stands for it: samples
/// that agree with this one look there.
class Sights {
 public:
  Sights() = default;
  /// From the air, whatever is rough has been seen from the side, too, and from within: only what is `firm` counts.
  Sights(const RelationGraph& graph, const std::vector<Vec3f>& sights, bool from_air)
      : cosine_(sights.empty() ? 0 : graph.size()) {
    parallel_for(0, cosine_.size(), 16384, [&](std::size_t s) {
      if (from_air && !graph.firm(s)) return;
      cosine_[s] = std::clamp(dot(graph.normals()[s], sights[graph.tree().order()[s]]), -1.0f, 1.0f);
    });
  }

  bool known() const { return !cosine_.empty(); }
  /// Between normal and sight; 0 where that is unknown.
  float cosine(std::size_t s) const { return cosine_[s]; }
  void join(SignForest& forest, float least) const {
    const auto anchor = static_cast<std::uint32_t>(cosine_.size());
    for (std::uint32_t s = 0; s < anchor; ++s)
      if (std::abs(cosine_[s]) > least) forest.join(s, anchor, cosine_[s] < 0);
  }

  /// Whether each smooth patch has been seen from one side. Of large clouds some stretches along the tree are looked
  /// at.
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
      if (!(std::abs(cosine_[s]) > kLeastSight)) continue;
      const SignForest::Root root = forest.find(static_cast<std::uint32_t>(s));
      const double weight = static_cast<double>(cosine_[s]) * static_cast<double>(cosine_[s]);
      ((cosine_[s] < 0) != root.flip ? differ : agree)[root.index] += weight;
    }
    double contradiction = 0, all = 0;
    for (std::size_t s = 0; s < n; ++s) contradiction += std::min(agree[s], differ[s]), all += agree[s] + differ[s];
    return all > 0 && contradiction <= kMostContradiction * all;
  }

 private:
  /// The sample after s, where one stretch in `skip` is looked at.
  static std::size_t next_of_stretch(std::size_t s, std::size_t skip) {
    ++s;
    return s % kStretchSamples == 0 ? s + (skip - 1) * kStretchSamples : s;
  }

  std::vector<float> cosine_;
};

// Smooth patches first, from the most certain relations to the less certain; then patch by patch, by the vote of all
// relations between them. What has clearly been seen from one side is certain before, the rest of it after the patches.
void propagate(const RelationGraph& graph, const Sights& sights, SignForest& forest, Progress& progress) {
  if (sights.known()) {
    sights.join(forest, kClearSight);
    forest.flatten();
  } else {
    join_stretches(graph, forest, kSure[0]);
  }
  for (const int sure : kSure) {
    join_sure(graph, forest, sure);
    progress.advance(graph.size());
  }
  if (sights.known()) sights.join(forest, kLeastSight);
  forest.flatten();
  const auto between = [&](std::size_t s, std::size_t k) {
    return forest.flat_root(static_cast<std::uint32_t>(s)).index != forest.flat_root(graph.neighbour(s, k)).index;
  };
  std::vector<SignVote> votes;
  visit_edges(graph, between, [&](const Edge& e) {
    const std::int64_t r = graph.relation_to(e.sample, e.rank);
    votes.push_back({e.sample, graph.neighbour(e.sample, e.rank), r * std::abs(r)});
  });
  contract(forest, votes);
  progress.advance(graph.size());
}

/// Connected parts of the graph, and the sign of each sample that makes it agree with the others of its part.
struct Parts {
  std::vector<std::uint32_t> part;  ///< of each sample
  std::vector<std::int8_t> sign;
  std::size_t count = 0;
  /// How surely the signs make the part's normals point outward: negative = they point inward.
  std::vector<double> outwardness;
  /// Parts so far from closed that they have no outside.
  std::vector<std::uint8_t> open;
  /// The part whose samples have been seen from a known side, and the sign that makes them look there.
  std::optional<std::uint32_t> seen;
  std::int8_t seen_sign = 1;
};

Parts collect_parts(const RelationGraph& graph, const Sights& sights, SignForest& forest) {
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
  if (sights.known()) {
    // No sample may have joined them: all seen at a grazing angle, or by scanners that are not there.
    const SignForest::Root root = forest.find(static_cast<std::uint32_t>(graph.size()));
    if (name[root.index] != kNone) parts.seen = name[root.index], parts.seen_sign = root.flip ? -1 : 1;
  }
  return parts;
}

// Single samples that contradict most of their surroundings. How a sample was seen counts as much as all of those.
void polish(const RelationGraph& graph, const Sights& sights, Parts& parts) {
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
        vote += std::lround(weight * sights.cosine(s) * std::abs(sights.cosine(s)));
      if (vote * before[s] < 0) parts.sign[s] = static_cast<std::int8_t>(-before[s]);
    });
  }
}

// Points of a Fibonacci lattice on the sphere.
Vec3f direction(int i) {
  const double z = 1 - (2 * i + 1.0) / kExtremeDirections, r = std::sqrt(1 - z * z);
  const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
  return Vec3f(Vec3{r * std::cos(angle), r * std::sin(angle), z});
}

// The volume that the normals claim to enclose, relative to what it could be, plus the mean cosine between normals and
// the directions in which their samples are extremal. A part that lies so flat that neither tells (a terrain)
// looks up. Nothing is asked of the part that was seen from somewhere.
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
      if (t > distance[parts.part[s]] && graph.firm(s))  // strays are extremal, but their normals say nothing
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

std::string unknown_sights(OrientBy asked) {
  switch (asked) {
    case OrientBy::scanner:
      return "holds no scanner positions by which normals could be oriented";
    case OrientBy::rows:
      return "has no rows and columns by which normals could be oriented";
    case OrientBy::flight:
      return "holds no scan angles that show flight lines by which normals could be oriented";
    default:
      return "nothing is known by which normals could be oriented";
  }
}

/// The share of what neighbours say, by its weight, that confirms the given signs.
double agreement_of(const RelationGraph& graph) {
  double agree = 0, all = 0;
  for (std::size_t s = 0; s < graph.size(); ++s)
    for (std::size_t k = 0; k < graph.degree(); ++k) {
      const double r = graph.relation_to(s, k);
      all += r * r;
      if (r > 0) agree += r * r;
    }
  return all > 0 ? agree / all : 0;
}

// The given normals against those oriented anew.
OrientationReport judge(std::span<const Vec3f> positions, std::span<const Vec3f> normals, double noise) {
  Progress silent;
  const KdTree tree(positions);
  const RelationGraph graph(tree, normals, 10, noise);
  SignForest forest(graph.size());
  const Sights unknown;
  propagate(graph, unknown, forest, silent);
  Parts parts = collect_parts(graph, unknown, forest);
  polish(graph, unknown, parts);
  judge_outwardness(graph, parts);

  // In each part the signs that the majority has are taken as given; the others had to be flipped.
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
  // Where flipped and unflipped samples meet, the given normals must have contradicted each other: else the flip was
  // arbitrary, as between the sides of a thin sheet.
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
  report.agreement = agreement_of(graph);
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

bool from_air(OrientBy by) { return by == OrientBy::flight || by == OrientBy::up; }

/// The first in the order of trust that is known and believable; or what is asked for.
OrientBy choose_sights(const PointSet& points, const RelationGraph& graph, OrientBy asked, double noise,
                       Sights& sights) {
  if (asked == OrientBy::propagation) return asked;
  if (asked != OrientBy::automatic) {
    const std::vector<Vec3f> found = find_sights(points, asked);
    if (found.empty()) throw DataError(unknown_sights(asked));
    sights = Sights(graph, found, from_air(asked));
    return asked;
  }
  for (const OrientBy by : kOrientationOrder) {
    const std::vector<Vec3f> found = find_own_sights(points, by, noise);
    if (found.empty()) continue;
    sights = Sights(graph, found, from_air(by));
    if (sights.believable(graph)) return by;
  }
  sights = {};
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
  Sights sights;
  const OrientBy by = choose_sights(points, graph, options.by, noise, sights);
  SignForest forest(graph.size() + 1);
  propagate(graph, sights, forest, progress);
  Parts parts = collect_parts(graph, sights, forest);
  polish(graph, sights, parts);
  judge_outwardness(graph, parts);
  parallel_for(0, graph.size(), 16384, [&](std::size_t s) {
    const std::uint32_t p = parts.part[s];
    bool flip = (parts.sign[s] < 0) != (parts.outwardness[p] < 0);
    if (parts.seen && p == *parts.seen) flip = (parts.sign[s] < 0) != (parts.seen_sign < 0);
    if (flip) points.normals[graph.tree().order()[s]] = -graph.normals()[s];
  });
  progress.finish();
  return by;
}

double share_looking_away(const PointSet& points, std::span<const Vec3f> sights) {
  std::size_t away = 0, clear = 0;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const float cosine = dot(points.normals[i], sights[i]);
    clear += std::abs(cosine) > kLeastSight;
    away += cosine < -kLeastSight;
  }
  return clear > 0 ? static_cast<double>(away) / static_cast<double>(clear) : 0;
}

OrientationCheck check_orientation(const PointSet& points, std::optional<double> known_noise) {
  return measure_orientation(points, known_noise).check;
}

OrientationReport measure_orientation(const PointSet& points, std::optional<double> known_noise) {
  if (points.normals.size() != points.size()) return {};
  std::vector<Vec3f> positions, normals;
  std::size_t with_normal = 0;
  for (const Vec3f& n : points.normals) with_normal += squared_norm(n) > 0.25f;
  if (with_normal * 10 < points.size() || with_normal == 0) return {};
  // Equal steps through the samples that have a normal.
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
  const OrientationReport judgement = judge(positions, normals, noise);
  // The sides of a thin sheet may have been taken for noise.
  if (judgement.check != OrientationCheck::unoriented || noise == 0) return judgement;
  return judge(positions, normals, 0);
}

}  // namespace sansmesh
