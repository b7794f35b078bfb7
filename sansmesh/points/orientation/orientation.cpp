#include "sansmesh/points/orientation/orientation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/points/cleaning/hidden_samples.h"
#include "sansmesh/points/orientation/relation_graph.h"
#include "sansmesh/points/orientation/sign_graph.h"
#include "sansmesh/points/orientation/sign_parts.h"
#include "sansmesh/points/orientation/winding_doubt.h"
#include "sansmesh/points/orientation/winding_orientation.h"
#include "sansmesh/points/statistics/noise.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

using detail::kLeastSensorCosine, detail::kNoContradiction, detail::Parts, detail::RelationGraph, detail::SensorCosines;

constexpr std::size_t kCheckSamples = 30000;
/// Signs are correct with the agreement `kNoContradiction` unless whole regions are reversed, which doubt above the
/// first value indicates; or with the second agreement and doubt of at most the third value. (48 noisy clouds of known
/// shapes: see docs/methods/points.md.)
constexpr double kMostDoubtOfSmooth = 0.25;
constexpr double kLittleContradiction = 0.9955, kMostDoubt = 0.05;

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
  Parts parts = propagated_parts(graph, {}, silent);
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
    if (by == OrientBy::up) sensor.forget(detail::find_hidden_from_above(graph));
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
    Vec3f& normal = points.normals[graph.tree().order()[s]];
    if (flip) normal = -normal;
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

OrientationReport measure_orientation(const PointSet& points, std::optional<double> known_noise, bool with_doubt) {
  return judge_some(points, known_noise, with_doubt);
}

}  // namespace sansmesh::inline v1
