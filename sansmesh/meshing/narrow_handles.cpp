#include "sansmesh/meshing/narrow_handles.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numbers>
#include <set>
#include <unordered_map>
#include <vector>

#include "sansmesh/mesh/repair/cut_handles.h"
#include "sansmesh/mesh/repair/handle_loops.h"
#include "sansmesh/points/spacing.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1::detail {
namespace {

/// A handle is narrow up to this width: in local spacings, and in standard deviations of the noise.
constexpr double kNarrowSpacings = 2, kNarrowNoises = 4;
/// Handles up to this multiple of the narrow width are also closed, if hardly any sample supports their walls.
constexpr double kWide = 2;
/// Loops on open surfaces, and walls where caps have no samples either, are cut up to this share of the narrow width.
constexpr double kUnresolved = 0.5;
/// Supported shares of a loop: at least the first for a handle to be real, less than the second for a wide one to be
/// spurious.
constexpr double kReal = 0.5, kBare = 0.25;
/// A sample supports a point of the surface if it is among this number of nearest samples, within this distance in local
/// spacings or deviations of the noise, and its normal is within 53°.
constexpr std::size_t kWitnesses = 8;
constexpr double kWitnessSpacings = 1.2, kWitnessNoises = 2.5, kWitnessCosine = 0.6;
/// Widths of the removed band over the length of the loop, in the order of trial.
constexpr double kBands[] = {0.35, 0.6, 0.2, 0.1, 0};
/// Labels have 64 bits: independence of more loops than this cannot be tested reliably.
constexpr std::size_t kMostCuts = 48;
constexpr int kMostRounds = 8;

/// Evidence of the samples.
class HandleWitnesses {
 public:
  HandleWitnesses(const TriangleMesh& mesh, const PointSet& points, double spacing, double noise)
      : points_(points), tree_(points.positions), shift_(mesh.origin - points.origin), spacing_(spacing), noise_(noise) {}

  bool known() const { return points_.normals.size() == points_.size() && tree_.size() > 0; }

  /// Local spacing of the samples around the one nearest to x.
  double spacing_at(const Vec3& x) const {
    const auto nearest = tree_.nearest(Vec3f(x + shift_));
    if (!nearest) return spacing_;
    std::array<Neighbour, kLocalNeighbours> around;
    const std::size_t count = tree_.nearest(points_.positions[nearest->index], around);
    if (count < around.size()) return spacing_;
    return local_spacing(static_cast<double>(around.back().squared_distance), spacing_);
  }
  /// Width up to which a handle at x is narrow.
  double narrow_width(const Vec3& x) const { return std::max(kNarrowSpacings * spacing_at(x), kNarrowNoises * noise_); }

  bool supported(const Vec3& x, const Vec3& normal) const {
    const double radius = std::max(kWitnessSpacings * spacing_at(x), kWitnessNoises * noise_);
    std::array<Neighbour, kWitnesses> near;
    const std::size_t count = tree_.nearest(Vec3f(x + shift_), near);
    for (std::size_t i = 0; i < count; ++i) {
      if (static_cast<double>(near[i].squared_distance) > radius * radius) return false;
      if (dot(Vec3(points_.normals[near[i].index]), normal) > kWitnessCosine) return true;
    }
    return false;
  }

 private:
  const PointSet& points_;
  KdTree tree_;
  Vec3 shift_;
  double spacing_, noise_;
};

Vec3 area_normal(const TriangleMesh& mesh, std::uint32_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  const Vec3 p(mesh.vertices[a]);
  return cross(Vec3(mesh.vertices[b]) - p, Vec3(mesh.vertices[c]) - p);
}

Vec3 center_of(const TriangleMesh& mesh, const HandleLoop& loop) {
  Vec3 sum;
  for (const std::uint32_t v : loop.vertices) sum += Vec3(mesh.vertices[v]);
  return sum / static_cast<double>(loop.vertices.size());
}

/// Share of the loop that samples support, with the normals of the triangles around its vertices and edges.
double loop_support(const TriangleMesh& mesh, const HandleClasses& classes, const HandleLoop& loop,
                    const HandleWitnesses& witnesses) {
  const VertexCorners& corners = classes.corners();
  const std::size_t n = loop.vertices.size();
  std::vector<double> weight(n, 0);
  double supported = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t v = loop.vertices[i], w = loop.vertices[(i + 1) % n];
    const Vec3 a(mesh.vertices[v]), b(mesh.vertices[w]);
    const double length = norm(b - a);
    weight[i] += length / 4, weight[(i + 1) % n] += length / 4;
    Vec3 normal;
    for (std::uint32_t k = corners.first[v]; k < corners.first[v + 1]; ++k) {
      const std::uint32_t h = corners.entries[k], before = HandleClasses::previous(h);
      if (classes.to(h) == w || classes.from(before) == w) normal += area_normal(mesh, h / 3);
    }
    if (squared_norm(normal) > 0 && witnesses.supported((a + b) / 2, normalized(normal))) supported += length / 2;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t v = loop.vertices[i];
    Vec3 normal;
    for (std::uint32_t k = corners.first[v]; k < corners.first[v + 1]; ++k)
      normal += area_normal(mesh, corners.entries[k] / 3);
    if (squared_norm(normal) > 0 && witnesses.supported(Vec3(mesh.vertices[v]), normalized(normal)))
      supported += weight[i];
  }
  return loop.length > 0 ? supported / loop.length : 0;
}

/// Share of the caps' area that samples support; the lower one of the two.
double cap_support(const TriangleMesh& mesh, const HandleCut& cut, const HandleWitnesses& witnesses) {
  double least = 1;
  for (const HandleCap& cap : cut.caps) {
    double all = 0, supported = 0;
    for (const Triangle& t : cap.triangles) {
      const Vec3 a = cap.position(mesh, t[0]), b = cap.position(mesh, t[1]), c = cap.position(mesh, t[2]);
      const Vec3 normal = cross(b - a, c - a);
      const double area = norm(normal);
      all += area;
      if (area > 0 && witnesses.supported((a + b + c) / 3, normal / area)) supported += area;
    }
    least = std::min(least, all > 0 ? supported / all : 0);
  }
  return least;
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
  void add(std::uint64_t label) {
    label = reduced(label);
    if (label == 0) return;
    rows_.push_back(label);
    std::sort(rows_.rbegin(), rows_.rend());
  }

 private:
  std::vector<std::uint64_t> rows_;  ///< descending, each with a leading bit that no other row has as its leading bit
};

enum class HandleFate { ordinary, narrow, cut };

struct HandleDecision {
  HandleFate fate = HandleFate::ordinary;
  HandleCut cut;
};

/// The first cut with sound caps that the samples support better than the handle, and its caps' support.
HandleDecision decide_handle(const TriangleMesh& mesh, const HandleClasses& classes, const HandleLoop& loop,
                             const HandleWitnesses& witnesses, bool open, bool close) {
  HandleDecision decision;
  const double narrow = std::numbers::pi * witnesses.narrow_width(center_of(mesh, loop));
  const double wall = witnesses.known() ? loop_support(mesh, classes, loop, witnesses) : 1;
  const bool unresolved = loop.length <= kUnresolved * narrow;
  const bool bare = wall < kBare && loop.length <= kWide * narrow;
  if (loop.length <= narrow || bare) decision.fate = HandleFate::narrow;
  const bool candidate = close && wall < kReal && (open ? unresolved : loop.length <= narrow || bare);
  if (!candidate) return decision;
  for (const double band : kBands) {
    std::optional<HandleCut> cut = cut_handle(mesh, classes, loop, band * loop.length);
    if (!cut || caps_intersect(mesh, *cut)) continue;
    const double caps = cap_support(mesh, *cut, witnesses);
    if (!unresolved && (caps <= wall || (loop.length > narrow && caps < kReal))) continue;
    return {HandleFate::cut, std::move(*cut)};
  }
  return decision;
}

/// One round over all short loops, shortest first. Loops next to a previous one wait for the next round.
std::vector<HandleCut> choose_cuts(const TriangleMesh& mesh, const HandleClasses& classes,
                                   const HandleWitnesses& witnesses, bool close, NarrowHandles& result) {
  const std::vector<HandleLoop> loops = classes.short_loops([&](std::uint32_t v) {
    return kWide * std::numbers::pi * witnesses.narrow_width(Vec3(mesh.vertices[v]));
  });
  std::vector<HandleCut> cuts;
  std::unordered_map<std::uint32_t, IndependentLabels> independent;
  std::set<std::pair<std::uint32_t, std::uint64_t>> seen;
  std::vector<std::uint8_t> taken(loops.empty() ? 0 : mesh.vertices.size(), 0);
  result.narrow = 0;
  double shortest = 0;
  for (const HandleLoop& loop : loops) {
    if (std::any_of(loop.vertices.begin(), loop.vertices.end(), [&](std::uint32_t v) { return taken[v] != 0; }))
      continue;
    IndependentLabels& labels = independent[loop.component];
    if (labels.reduced(loop.label) == 0 || !seen.emplace(loop.component, loop.label).second) continue;
    const bool more = close && labels.size() < kMostCuts;
    HandleDecision decision = decide_handle(mesh, classes, loop, witnesses, classes.open(loop.component), more);
    if (decision.fate == HandleFate::ordinary) continue;
    for (const std::uint32_t v : loop.vertices) taken[v] = 1;
    const auto touched = [&](std::uint32_t t) {
      return std::any_of(mesh.triangles[t].begin(), mesh.triangles[t].end(), [&](std::uint32_t v) { return taken[v] == 2; });
    };
    if (decision.fate == HandleFate::cut &&
        std::none_of(decision.cut.band.begin(), decision.cut.band.end(), touched)) {
      labels.add(loop.label);
      for (const std::uint32_t t : decision.cut.band)
        for (const std::uint32_t v : mesh.triangles[t]) taken[v] = 2;
      cuts.push_back(std::move(decision.cut));
    } else {
      if (result.narrow++ == 0 || loop.length < shortest)
        shortest = loop.length, result.narrowest = mesh.origin + center_of(mesh, loop);
    }
  }
  return cuts;
}

}  // namespace

NarrowHandles close_handles(TriangleMesh& mesh, const PointSet& points, double spacing, double noise, bool close) {
  NarrowHandles result;
  std::optional<HandleWitnesses> witnesses;
  for (int round = 0; round <= kMostRounds; ++round) {
    const HandleClasses classes(mesh);
    result.genus = classes.genus();
    result.narrow = 0;
    if (result.genus == 0) return result;
    if (!witnesses) witnesses.emplace(mesh, points, spacing, noise);
    const bool may_close = close && witnesses->known() && round < kMostRounds;
    const std::vector<HandleCut> cuts = choose_cuts(mesh, classes, *witnesses, may_close, result);
    if (cuts.empty()) break;
    apply_cuts(mesh, cuts);
    result.closed += cuts.size();
  }
  result.narrow = std::min(result.narrow, result.genus);
  return result;
}

}  // namespace sansmesh::inline v1::detail
