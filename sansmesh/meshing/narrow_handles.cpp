#include "sansmesh/meshing/narrow_handles.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <numbers>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/core/boxes.h"
#include "sansmesh/mesh/repair/cut_handles.h"
#include "sansmesh/mesh/repair/handle_loops.h"
#include "sansmesh/meshing/handle_evidence.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1::detail {
namespace {

/// Loops are searched up to this multiple of the length at which a handle is narrow.
constexpr double kWide = 2;
/// Loops shorter than this share of that length are below the resolution of the samples.
constexpr double kUnresolved = 0.5;
/// Support of the loop from which on a handle is real; below the second value it has none.
constexpr double kReal = 0.58, kBare = 0.25;
/// Samples that a cut may lose: a number, or a share of those in its reach. Samples that it must gain if the handle is
/// wide or the surface open, and that show a cover.
constexpr double kMayLose = 0.5, kMayLoseShare = 0.05, kMustGain = 3, kGains = 1;
/// Share of each cap's area that samples must support if the handle is not below their resolution.
constexpr double kCovered = 0.5;
/// Widths of the removed band over the length of the loop, in the order of trial.
constexpr double kBands[] = {0.35, 0.6, 0.2, 0.1, 0};
/// Labels have 64 bits, so that independent labels may seem dependent on this number of others or more. Loops to be cut
/// then wait for the next round; for the number of narrow handles all further ones count.
constexpr std::size_t kMostLabels = 56;
constexpr int kMostRounds = 4;
/// Loops of one class, and of one component in a round, that are tried.
constexpr int kMostTries = 3;
constexpr std::size_t kMostLoops = 500;
/// Another round follows if the last one closed at least this share of the narrow handles.
constexpr double kWorthwhile = 0.05;
/// Samples contradict each other around more handles of a component than this; they stay.
constexpr std::size_t kContradiction = 2000;

Vec3 center_of(const TriangleMesh& mesh, const HandleLoop& loop) {
  Vec3 sum;
  for (const std::uint32_t v : loop.vertices) sum += Vec3(mesh.vertices[v]);
  return sum / static_cast<double>(loop.vertices.size());
}

/// Independent classes of loops on one component: loops of a set separate it together if and only if their labels are
/// dependent.
class IndependentLabels {
 public:
  std::size_t size() const { return rows_.size(); }
  std::uint64_t reduced(std::uint64_t label) const {
    for (const std::uint64_t row : rows_) label = std::min(label, label ^ row);
    return label;
  }
  /// Adds a label unless it is dependent; returns whether it did.
  bool add(std::uint64_t label) {
    label = reduced(label);
    if (label == 0) return false;
    rows_.push_back(label);
    std::sort(rows_.rbegin(), rows_.rend());
    return true;
  }

 private:
  std::vector<std::uint64_t> rows_;  ///< descending, each with a leading bit that no other row has as its leading bit
};

/// The first cut along a loop with sound caps that the samples allow.
std::optional<HandleCut> allowed_cut(const TriangleMesh& mesh, const HandleClasses& classes, const HandleLoop& loop,
                                     const HandleEvidence& evidence, double narrow) {
  const bool unresolved = loop.length <= kUnresolved * narrow;
  if (classes.open(loop.component) && !unresolved) return std::nullopt;
  const double support = evidence.support(classes, loop);
  if (support >= kReal) return std::nullopt;
  const bool must_gain = loop.length > narrow;
  for (const double band : kBands) {
    std::optional<HandleCut> cut = cut_handle(mesh, classes, loop, band * loop.length);
    if (!cut) continue;
    const HandleEvidence::Change change = evidence.change(classes, *cut);
    const double may_lose = std::max(kMayLose, kMayLoseShare * static_cast<double>(change.samples));
    if (change.gain < (must_gain ? kMustGain : -may_lose)) continue;
    const bool covers = unresolved || support < kBare || change.gain >= kGains || evidence.covers(*cut, kCovered);
    if (covers && !caps_intersect(mesh, *cut, change.around)) return cut;
  }
  return std::nullopt;
}

/// Box of the caps of a cut.
Box3 box_of(const TriangleMesh& mesh, const HandleCut& cut) {
  Box3 box;
  for (const HandleCap& cap : cut.caps)
    for (std::uint32_t k = 0; k < cap.rim.size() + cap.fresh.size(); ++k) box.extend(cap.position(mesh, k));
  return box;
}

/// One round over all short loops, shortest first. Loops next to a previous one wait for the next round.
std::vector<HandleCut> choose_cuts(const TriangleMesh& mesh, const HandleClasses& classes,
                                   const HandleEvidence& evidence, bool close, NarrowHandles& result) {
  const std::vector<HandleLoop> loops = classes.short_loops([&](std::uint32_t component, std::uint32_t v) {
    if (classes.genus(component) > kContradiction) return 0.0;
    const double narrow = std::numbers::pi * evidence.narrow_width(Vec3(mesh.vertices[v]));
    return !close ? narrow : classes.open(component) ? kUnresolved * narrow : kWide * narrow;
  });
  std::vector<HandleCut> cuts;
  std::vector<Box3> regions;  // boxes of the caps, so that those of two cuts do not cross
  std::unordered_map<std::uint32_t, IndependentLabels> independent, named;
  std::map<std::pair<std::uint32_t, std::uint64_t>, int> tries;
  std::unordered_map<std::uint32_t, std::size_t> judged;
  constexpr std::uint8_t kCut = 1, kNamed = 2;
  std::vector<std::uint8_t> taken(loops.empty() ? 0 : mesh.vertices.size(), 0);
  const auto touches = [&](const auto& vertices, std::uint8_t by) {
    return std::any_of(vertices.begin(), vertices.end(), [&](std::uint32_t v) { return (taken[v] & by) != 0; });
  };
  for (const HandleLoop& loop : loops) {
    IndependentLabels& labels = independent[loop.component];
    int& tried = tries[{loop.component, loop.label}];
    if (tried == kMostTries || labels.reduced(loop.label) == 0 || touches(loop.vertices, kCut)) continue;
    const Vec3 center = center_of(mesh, loop);
    const double narrow = std::numbers::pi * evidence.narrow_width(center);
    ++tried;
    std::optional<HandleCut> cut;
    if (close && judged[loop.component]++ < kMostLoops) cut = allowed_cut(mesh, classes, loop, evidence, narrow);
    const Box3 region = cut ? box_of(mesh, *cut) : Box3{};
    if (cut &&
        std::none_of(cut->band.begin(), cut->band.end(),
                     [&](std::uint32_t t) { return touches(mesh.triangles[t], kCut); }) &&
        !any_touches(regions, region)) {
      regions.push_back(region);
      labels.add(loop.label);
      for (const std::uint32_t t : cut->band)
        for (const std::uint32_t v : mesh.triangles[t]) taken[v] |= kCut;
      cuts.push_back(std::move(*cut));
    } else if (loop.length <= narrow && !touches(loop.vertices, kNamed) &&
               (named[loop.component].size() >= kMostLabels || named[loop.component].add(loop.label))) {
      for (const std::uint32_t v : loop.vertices) taken[v] |= kNamed;
      if (result.narrow++ == 0) result.narrowest = mesh.origin + center;
    }
  }
  return cuts;
}

}  // namespace

NarrowHandles close_handles(TriangleMesh& mesh, const PointSet& points, double spacing, double noise, bool close) {
  NarrowHandles result;
  std::optional<KdTree> samples;
  std::optional<HandleEvidence> evidence;
  for (int round = 0;; ++round) {
    const HandleClasses classes(mesh);
    result.genus = classes.genus();
    result.narrow = 0;
    if (result.genus == 0) return result;
    if (!samples) {
      samples.emplace(points.positions);
      evidence.emplace(mesh, points, *samples, spacing, noise);
    }
    close = close && evidence->known() && round < kMostRounds;
    const std::vector<HandleCut> cuts =
        close ? choose_cuts(mesh, classes, *evidence, true, result) : std::vector<HandleCut>{};
    if (cuts.empty()) {
      result.narrow = 0;
      choose_cuts(mesh, classes, *evidence, false, result);
      break;
    }
    apply_cuts(mesh, cuts);
    evidence->mesh_changed();
    result.closed += cuts.size();
    close = static_cast<double>(cuts.size()) >= kWorthwhile * static_cast<double>(result.narrow);
  }
  result.narrow = std::min(result.narrow, result.genus);
  return result;
}

}  // namespace sansmesh::inline v1::detail
