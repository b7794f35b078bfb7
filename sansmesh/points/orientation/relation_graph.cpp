#include "sansmesh/points/orientation/relation_graph.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/median.h"

namespace sansmesh::inline v1::detail {
namespace {

/// Heights below this many noise levels are ignored. Within sheets close to each other the factor is smaller, since a
/// single edge across would join them.
constexpr double kUnseen = 3, kUnseenWithin = 2;
/// Number of samples, and stretch of adjacent ones, for estimating the noise within sheets. Above the first limit (in
/// spacings) it can be distinguished from shape; above the second the nearest neighbours are no longer those along the
/// surface. Given noise below or above these factors of the estimate is replaced.
constexpr std::size_t kSheetSamples = 5000, kSheetStretch = 16;
constexpr double kCertainNear = 0.15, kLargestNear = 0.45;
constexpr double kHiddenNoise = 0.67, kSheetsAsNoise = 1.5, kSheetsWithoutNoise = 2.5;
/// Mean magnitude (of 127) of a sample's relations below which its normal is uninformative: a stray sample, or foliage.
constexpr int kFirm = 30;
/// Largest ratio of a sample's area to that of its neighbours: bounds stray samples.
constexpr float kLargestArea = 4;

/// Relation of the signs of the normals at both ends of an edge: +1 equal, −1 opposite, 0 unknown. The normals at the
/// ends of an arc are mirror images in the bisecting plane of the chord, for flat, round and creased arcs [koenig2009].
/// Edges at equal steep angles to both tangent planes connect two sheets and are uninformative. Heights below `unseen`
/// count as zero, otherwise noise would look like many sheets.
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
  return whole_part<std::int8_t>(std::round(std::clamp(relation_value, -1.0f, 1.0f) * 127));
}

}  // namespace

RelationGraph::RelationGraph(const KdTree& tree, std::span<const Vec3f> normals, int neighbours, double noise)
    : tree_(tree), degree_(static_cast<std::size_t>(neighbours)) {
  const std::size_t n = tree_.size();
  positions_ = tree_.positions();
  normals_.resize(n);
  area_.resize(n);
  neighbours_.resize(n * degree_);
  relations_.resize(n * degree_);
  parallel_for(0, n, 16384, [&](std::size_t s) {
    const Vec3f& normal = normals[tree_.order()[s]];
    normals_[s] = is_finite(normal) ? normal : Vec3f{};
  });
  noise_ = within_sheet(noise);
  close_sheets_ = noise_ < noise;
  const auto unseen = static_cast<float>(noise_ == noise ? kUnseen * noise : kUnseenWithin * noise_);
  tree_.for_each_nearest(degree_ + 1, [&](std::uint32_t s, std::span<const Neighbour> found) {
    std::size_t count = 0;
    for (const Neighbour& neighbour : found) {
      if (neighbour.index == s || count == degree_) continue;
      neighbours_[s * degree_ + count] = neighbour.index;
      relations_[s * degree_ + count++] = quantized(
          relation(positions_[s], normals_[s], positions_[neighbour.index], normals_[neighbour.index], unseen));
    }
    for (; count < degree_; ++count) neighbours_[s * degree_ + count] = s;  // a loop, which is uninformative
    area_[s] = found.back().squared_distance;
  });
  limit_areas();
}

bool RelationGraph::firm(std::size_t s) const {
  int sure = 0;
  for (std::size_t k = 0; k < degree_; ++k) sure += std::abs(relation_to(s, k));
  return sure >= kFirm * static_cast<int>(degree_) && squared_norm(normals_[s]) > 0;
}

double RelationGraph::agreement() const { return agreement({}); }

double RelationGraph::agreement(std::span<const std::int8_t> sign) const {
  double agree = 0, all = 0;
  for (std::size_t s = 0; s < size(); ++s)
    for (std::size_t k = 0; k < degree_; ++k) {
      const double r = relation_to(s, k);
      all += r * r;
      const bool opposite = !sign.empty() && sign[s] != sign[neighbour(s, k)];
      if (opposite ? r < 0 : r > 0) agree += r * r;
    }
  return all > 0 ? agree / all : 0;
}

double RelationGraph::within_sheet(double noise) const {
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
  // For normal deviates: differences of two have √2 times their deviation, and half of them are within 0.67 of that.
  const double near = static_cast<double>(median(off)) / (0.6745 * std::numbers::sqrt2);
  const bool certain = near > kCertainNear * spacing;
  const bool hidden = certain && noise < kHiddenNoise * near;
  const bool sheets = noise > (certain ? kSheetsAsNoise : kSheetsWithoutNoise) * near;
  return near < kLargestNear * spacing && (hidden || sheets) ? near : noise;
}

void RelationGraph::limit_areas() {
  std::vector<float> some;
  for (std::size_t s = 0; s < size(); s += 1 + size() / kSheetSamples) some.push_back(area_[s]);
  if (some.empty()) return;
  const float large = kLargestArea * median(some);
  const std::vector<float> raw = area_;
  parallel_for(0, size(), 8192, [&](std::size_t s) {
    if (raw[s] <= large) return;  // the usual case
    std::vector<float> around(degree_);
    for (std::size_t k = 0; k < degree_; ++k) around[k] = raw[neighbour(s, k)];
    area_[s] = std::min(raw[s], kLargestArea * median(around));
  });
}

void join_stretches(const RelationGraph& graph, SignForest& forest, int sure, std::size_t stretch,
                    std::span<const std::uint8_t> only) {
  const std::size_t several = stretch < kEdgeSamples ? kEdgeSamples / stretch : 1, stretches = several * stretch;
  parallel_for(0, (graph.size() + stretches - 1) / stretches, 1, [&](std::size_t c) {
    const std::size_t begin = c * stretches, end = std::min(graph.size(), begin + stretches);
    for (std::size_t s = begin; s < end; ++s)
      for (std::size_t k = 0; k < graph.degree(); ++k) {
        const int r = graph.relation_to(s, k);
        const std::uint32_t q = graph.neighbour(s, k);
        if (!only.empty() && !(only[s] && only[q])) continue;
        if (std::abs(r) >= sure && q / stretch == s / stretch) forest.join(static_cast<std::uint32_t>(s), q, r < 0);
      }
  });
  forest.flatten();
}

void join_sure(const RelationGraph& graph, SignForest& forest, int sure, std::span<const std::uint8_t> apart) {
  const auto joins = [&](std::size_t s, std::size_t k) {
    if (!apart.empty() && (apart[s] || apart[graph.neighbour(s, k)])) return false;
    return std::abs(graph.relation_to(s, k)) >= sure &&
           forest.flat_root(static_cast<std::uint32_t>(s)).index != forest.flat_root(graph.neighbour(s, k)).index;
  };
  visit_edges(graph, joins, [&](const RelationEdge& e) {
    forest.join(e.sample, graph.neighbour(e.sample, e.rank), graph.relation_to(e.sample, e.rank) < 0);
  });
  forest.flatten();
}

void join_by_votes(const RelationGraph& graph, SignForest& forest, std::vector<SignVote> votes) {
  const auto between = [&](std::size_t s, std::size_t k) {
    return forest.flat_root(static_cast<std::uint32_t>(s)).index != forest.flat_root(graph.neighbour(s, k)).index;
  };
  visit_edges(graph, between, [&](const RelationEdge& e) {
    const std::int64_t r = graph.relation_to(e.sample, e.rank);
    votes.push_back({e.sample, graph.neighbour(e.sample, e.rank), r * std::abs(r)});
  });
  contract(forest, votes);
}

}  // namespace sansmesh::inline v1::detail
