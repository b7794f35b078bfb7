#include "sansmesh/points/orientation/winding_orientation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <utility>
#include <vector>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/points/orientation/sign_graph.h"
#include "sansmesh/points/orientation/winding_sides.h"

namespace sansmesh::inline v1::detail {
namespace {

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
  WindingSides sides;
};

/// Signs of a part that seems open change only where sheets are close to each other.
bool has_sides(const RelationGraph& graph, bool open) { return !open || graph.has_close_sheets(); }

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
    if (members[p].size() >= kFewestOfWinding && has_sides(graph, parts.open[p] != 0)) order.push_back(p);
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
    WindingSides sides(graph, members[p], own_step);
    const Consistency now{neighbours[p], sides.error(sign)};
    if (may_improve(parts.open[p] != 0, now)) doubtful.push_back({p, now, std::move(sides)});
  }
  return doubtful;
}

}  // namespace

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
    const SignForest::Root own = forest.find(s), outside = forest.find(static_cast<std::uint32_t>(n + parts.part[s]));
    // A part without any outward direction has no votes for its outside.
    if (own.index == outside.index) sign[s] = own.flip != outside.flip ? -1 : 1;
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

}  // namespace sansmesh::inline v1::detail
