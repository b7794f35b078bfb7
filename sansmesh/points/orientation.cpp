#include "sansmesh/points/orientation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/points/noise.h"
#include "sansmesh/points/sign_graph.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh {
namespace {

constexpr std::size_t kCheckSamples = 30000;
constexpr int kExtremeDirections = 64;

/// How the sign of the normals at both ends of an edge relate: near +1 surely equal, near -1 surely opposite, near 0
/// unknown. The normals at the ends of an arc mirror each other in the chord's bisecting plane, whether the arc is
/// flat, round or a crease (König & Gumhold 2009). Edges that climb out of both tangent planes alike join two sheets:
/// these say nothing. Heights of the order of the noise count as zero, or noise would look like many sheets.
float relation(const Vec3f& p, const Vec3f& n, const Vec3f& q, const Vec3f& m, float noise) {
  const Vec3f d = q - p;
  const float length = norm(d);
  const float cosine = dot(n, m);
  if (!(length > 0)) return cosine;
  const auto slope = [&](const Vec3f& normal) {
    const float height = dot(normal, d);
    return std::copysign(std::max(0.0f, std::abs(height) - 3 * noise), height) / length;
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
  RelationGraph(std::span<const Vec3f> positions, std::span<const Vec3f> normals, int neighbours, double noise)
      : tree_(positions), degree_(static_cast<std::size_t>(neighbours)) {
    const std::size_t n = tree_.size();
    positions_ = tree_.positions();
    normals_.resize(n);
    area_.resize(n);
    neighbours_.resize(n * degree_);
    relations_.resize(n * degree_);
    parallel_for(0, n, 16384, [&](std::size_t s) { normals_[s] = normals[tree_.order()[s]]; });
    tree_.for_each_nearest(degree_ + 1, [&](std::uint32_t s, std::span<const Neighbour> found) {
      std::size_t count = 0;
      for (const Neighbour& neighbour : found) {
        if (neighbour.index == s || count == degree_) continue;
        neighbours_[s * degree_ + count] = neighbour.index;
        relations_[s * degree_ + count++] = quantized(relation(positions_[s], normals_[s], positions_[neighbour.index],
                                                               normals_[neighbour.index], static_cast<float>(noise)));
      }
      for (; count < degree_; ++count) neighbours_[s * degree_ + count] = s;  // a loop: says nothing
      area_[s] = found.back().squared_distance;
    });
  }

  std::size_t size() const { return positions_.size(); }
  std::size_t degree() const { return degree_; }
  std::uint32_t neighbour(std::size_t s, std::size_t k) const { return neighbours_[s * degree_ + k]; }
  int relation_to(std::size_t s, std::size_t k) const { return relations_[s * degree_ + k]; }
  const KdTree& tree() const { return tree_; }
  const std::vector<Vec3f>& positions() const { return positions_; }
  const std::vector<Vec3f>& normals() const { return normals_; }
  const std::vector<float>& area() const { return area_; }  ///< up to a common factor

 private:
  KdTree tree_;
  std::size_t degree_;
  std::vector<Vec3f> positions_, normals_;
  std::vector<float> area_;
  std::vector<std::uint32_t> neighbours_;
  std::vector<std::int8_t> relations_;
};

// Smooth patches first, from the most certain relations to the less certain; then patch by patch, by the vote of all
// relations between them.
void propagate(const RelationGraph& graph, SignForest& forest, Progress& progress) {
  for (const int sure : {118, 105, 90, 75}) {
    for (std::size_t s = 0; s < graph.size(); ++s)
      for (std::size_t k = 0; k < graph.degree(); ++k) {
        const int r = graph.relation_to(s, k);
        if (std::abs(r) >= sure) forest.join(static_cast<std::uint32_t>(s), graph.neighbour(s, k), r < 0);
      }
    progress.advance(graph.size());
  }
  std::vector<SignVote> votes;
  for (std::size_t s = 0; s < graph.size(); ++s) {
    const std::uint32_t own = forest.find(static_cast<std::uint32_t>(s)).index;
    for (std::size_t k = 0; k < graph.degree(); ++k) {
      const std::uint32_t other = graph.neighbour(s, k);
      if (forest.find(other).index == own) continue;
      const std::int64_t r = graph.relation_to(s, k);
      votes.push_back({static_cast<std::uint32_t>(s), other, r * std::abs(r)});
    }
  }
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
};

Parts collect_parts(const RelationGraph& graph, SignForest& forest) {
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
  return parts;
}

// Single samples that contradict most of their surroundings.
void polish(const RelationGraph& graph, Parts& parts) {
  for (int round = 0; round < 2; ++round) {
    const std::vector<std::int8_t> before = parts.sign;
    parallel_for(0, graph.size(), 8192, [&](std::size_t s) {
      long vote = 0;
      for (std::size_t k = 0; k < graph.degree(); ++k) {
        const long r = graph.relation_to(s, k);
        vote += r * std::abs(r) * before[graph.neighbour(s, k)];
      }
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
// looks up.
void judge_outwardness(const RelationGraph& graph, Parts& parts) {
  const std::size_t n = graph.size();
  std::vector<Vec3> center(parts.count), up(parts.count);
  std::vector<double> area(parts.count), flux(parts.count), reach(parts.count), extremal(parts.count);
  for (std::size_t s = 0; s < n; ++s) {
    const double a = graph.area()[s];
    center[parts.part[s]] += Vec3(graph.positions()[s]) * a;
    area[parts.part[s]] += a;
  }
  for (std::size_t p = 0; p < parts.count; ++p)
    if (area[p] > 0) center[p] = center[p] / area[p];
  for (std::size_t s = 0; s < n; ++s) {
    const std::uint32_t p = parts.part[s];
    const Vec3 arm = Vec3(graph.positions()[s]) - center[p];
    const Vec3 normal = Vec3(graph.normals()[s]) * static_cast<double>(parts.sign[s]);
    const double a = graph.area()[s];
    flux[p] += a * dot(arm, normal);
    reach[p] += a * norm(arm) * norm(normal);
    up[p] += normal * a;
  }
  std::vector<std::uint32_t> farthest(parts.count);
  std::vector<float> distance(parts.count);
  for (int i = 0; i < kExtremeDirections; ++i) {
    const Vec3f d = direction(i);
    std::fill(distance.begin(), distance.end(), std::numeric_limits<float>::lowest());
    for (std::size_t s = 0; s < n; ++s) {
      const float t = dot(graph.positions()[s], d);
      if (t > distance[parts.part[s]] && squared_norm(graph.normals()[s]) > 0)
        distance[parts.part[s]] = t, farthest[parts.part[s]] = static_cast<std::uint32_t>(s);
    }
    for (std::size_t p = 0; p < parts.count; ++p)
      extremal[p] +=
          static_cast<double>(dot(graph.normals()[farthest[p]], d)) * parts.sign[farthest[p]] / kExtremeDirections;
  }
  parts.outwardness.resize(parts.count);
  for (std::size_t p = 0; p < parts.count; ++p) {
    double score = extremal[p] + (reach[p] > 0 ? flux[p] / reach[p] : 0);
    if (std::abs(score) < 0.25 && std::abs(up[p].z) > 0.5 * area[p]) score = std::copysign(0.01, up[p].z);
    parts.outwardness[p] = score;
  }
}

// Joins every sample that clearly faces or turns its back on its scanner with the node graph.size(): normals that agree
// with that node look at their scanner.
void join_scanners(const RelationGraph& graph, const PointSet& points, SignForest& forest) {
  const auto anchor = static_cast<std::uint32_t>(graph.size());
  for (std::uint32_t s = 0; s < anchor; ++s) {
    const std::uint16_t scan = points.scan_of_point[graph.tree().order()[s]];
    if (scan >= points.scanners.size()) continue;
    const float cosine = dot(graph.normals()[s], normalized(points.scanners[scan] - graph.positions()[s]));
    if (std::abs(cosine) > 0.25f) forest.join(s, anchor, cosine < 0);
  }
}

// The given normals against those oriented anew.
OrientationCheck judge(std::span<const Vec3f> positions, std::span<const Vec3f> normals, double noise) {
  Progress silent;
  const RelationGraph graph(positions, normals, 10, noise);
  SignForest forest(graph.size());
  propagate(graph, forest, silent);
  Parts parts = collect_parts(graph, forest);
  polish(graph, parts);
  judge_outwardness(graph, parts);

  // In each part the signs that the majority has are taken as given; the others had to be flipped.
  std::vector<std::size_t> members(parts.count), negative(parts.count);
  for (std::size_t s = 0; s < graph.size(); ++s) {
    ++members[parts.part[s]];
    negative[parts.part[s]] += parts.sign[s] < 0;
  }
  std::size_t flipped = 0, inward = 0;
  for (std::size_t p = 0; p < parts.count; ++p) {
    const bool turned = 2 * negative[p] > members[p];
    flipped += turned ? members[p] - negative[p] : negative[p];
    if ((turned ? -parts.outwardness[p] : parts.outwardness[p]) < -0.2) inward += members[p];
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
  if (static_cast<double>(flipped) > 0.06 * static_cast<double>(graph.size()) && systematic)
    return OrientationCheck::unoriented;
  return 2 * inward > graph.size() ? OrientationCheck::inward : OrientationCheck::oriented;
}

bool know_scanners(const PointSet& points) {
  return !points.scanners.empty() && points.scan_of_point.size() == points.size();
}

}  // namespace

void OrientationOptions::validate() const { check_range("neighbours", neighbours, 4, 100); }

void orient_normals(PointSet& points, const OrientationOptions& options, Progress& progress) {
  options.validate();
  if (points.normals.size() != points.size() || points.size() == 0)
    throw DataError("there are no normals to orient: estimate them first");
  progress.begin("orientation", 6 * points.size());
  const RelationGraph graph(points.positions, points.normals, options.neighbours,
                            options.noise ? *options.noise : estimate_noise(points));
  progress.advance(points.size());
  const auto anchor = static_cast<std::uint32_t>(graph.size());
  SignForest forest(graph.size() + 1);
  const bool scanners = options.use_scanners && know_scanners(points);
  if (scanners) join_scanners(graph, points, forest);
  propagate(graph, forest, progress);
  Parts parts = collect_parts(graph, forest);
  polish(graph, parts);
  judge_outwardness(graph, parts);
  const SignForest::Root anchor_root = forest.find(anchor);
  // No sample may have joined the scanners: all seen at a grazing angle, or by scanners that are not there.
  const bool anchored = scanners && anchor_root.index < graph.size();
  parallel_for(0, graph.size(), 16384, [&](std::size_t s) {
    const std::uint32_t p = parts.part[s];
    bool flip = (parts.sign[s] < 0) != (parts.outwardness[p] < 0);
    if (anchored && p == parts.part[anchor_root.index]) flip = (parts.sign[s] < 0) != anchor_root.flip;
    if (flip) points.normals[graph.tree().order()[s]] = -graph.normals()[s];
  });
  progress.finish();
}

OrientationCheck check_orientation(const PointSet& points, std::optional<double> known_noise) {
  if (points.normals.size() != points.size()) return OrientationCheck::missing;
  std::vector<Vec3f> positions, normals;
  std::size_t with_normal = 0;
  for (const Vec3f& n : points.normals) with_normal += squared_norm(n) > 0.25f;
  if (with_normal * 10 < points.size() || with_normal == 0) return OrientationCheck::missing;
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
  if (positions.empty()) return OrientationCheck::missing;
  const double noise = known_noise ? *known_noise : estimate_noise(points);
  const OrientationCheck judgement = judge(positions, normals, noise);
  // The sides of a thin sheet may have been taken for noise.
  if (judgement != OrientationCheck::unoriented || noise == 0) return judgement;
  return judge(positions, normals, 0);
}

}  // namespace sansmesh
