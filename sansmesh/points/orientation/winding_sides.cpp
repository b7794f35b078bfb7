#include "sansmesh/points/orientation/winding_sides.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sansmesh/core/median.h"

namespace sansmesh::inline v1::detail {
namespace {

/// Width of the kernel in spacings of the nodes and in noises, for errors; in the last round for directions; and the
/// ratio of the widths of the first and the last round.
constexpr double kErrorWidth = 2, kFinestSpacings = 0.7, kFinestNoises = 1.5, kWidest = 2.5;
constexpr int kRounds = 10;

struct Located {
  std::vector<Vec3f> nodes;
  float scale = 1;
};

/// Positions in a box of diagonal 1, so that powers of lengths stay within the range of float.
Located locate(const RelationGraph& graph, std::span<const std::uint32_t> nodes) {
  Located located;
  if (nodes.empty()) return located;
  Vec3f lower = graph.positions()[nodes[0]], upper = lower;
  for (const std::uint32_t s : nodes)
    for (std::size_t k = 0; k < 3; ++k) {
      lower[k] = std::min(lower[k], graph.positions()[s][k]);
      upper[k] = std::max(upper[k], graph.positions()[s][k]);
    }
  const float extent = norm(upper - lower);
  located.scale = extent > 0 ? 1 / extent : 1;
  located.nodes.reserve(nodes.size());
  for (const std::uint32_t s : nodes) located.nodes.push_back((graph.positions()[s] - lower) * located.scale);
  return located;
}

std::vector<std::uint32_t> every_nth(std::span<const std::uint32_t> members, std::size_t step) {
  std::vector<std::uint32_t> some;
  for (std::size_t i = step / 2; i < members.size(); i += step) some.push_back(members[i]);
  return some;
}

double sum_of_squares(std::span<const float> values) {
  double sum = 0;
  for (const float v : values) sum += static_cast<double>(v) * static_cast<double>(v);
  return sum;
}

}  // namespace

WindingSides::WindingSides(const RelationGraph& graph, std::span<const std::uint32_t> members, std::size_t step)
    : graph_(graph), nodes_(every_nth(members, step)) {
  const Located located = locate(graph, nodes_);
  scale_ = located.scale;
  sums_ = WindingSums(located.nodes);
  std::vector<float> area;
  area.reserve(nodes_.size());
  for (const std::uint32_t s : nodes_) area.push_back(graph.area()[s]);
  spacing_ = static_cast<double>(scale_) * std::sqrt(std::numbers::pi * static_cast<double>(median(area)) *
                                                     static_cast<double>(step) / static_cast<double>(graph.degree()));
  noise_ = graph.noise() * static_cast<double>(scale_);
}

double WindingSides::error(std::span<const std::int8_t> sign) const {
  std::vector<Vec3f> area(nodes_.size());
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const std::uint32_t s = nodes_[i];
    area[i] = graph_.normals()[s] * (graph_.area()[s] * scale_ * scale_ * static_cast<float>(sign[s]));
  }
  std::vector<float> winding(nodes_.size());
  sums_.winding(area, static_cast<float>(kErrorWidth * std::max(spacing_, noise_)), winding);
  double sum = 0;
  for (const float w : winding) sum += static_cast<double>(w);
  // NaN without area, or with a width of zero.
  const double even = sum * sum / (sum_of_squares(winding) * static_cast<double>(nodes_.size()));
  return std::isfinite(even) ? std::max(0.0, 1 - even) : 1;
}

std::vector<Vec3f> WindingSides::outward() const {
  const std::size_t n = nodes_.size();
  const double finest = std::max(kFinestSpacings * spacing_, kFinestNoises * noise_);
  std::vector<Vec3f> area(n), descent(n), outward(n);
  std::vector<float> winding(n), missing(n, 0.5f);
  for (int round = 0; round < kRounds; ++round) {
    const auto width = static_cast<float>(finest * std::pow(kWidest, 1 - round / (kRounds - 1.0)));
    if (round > 0) {
      sums_.winding(area, width, winding);
      for (std::size_t i = 0; i < n; ++i) missing[i] = 0.5f - winding[i];
    }
    // Steepest descent of Σ (w − ½)², to the minimum along the line.
    sums_.transposed(missing, width, descent);
    sums_.winding(descent, width, winding);
    double slope = 0;
    for (const Vec3f& d : descent) slope += static_cast<double>(squared_norm(d));
    const double bend = sum_of_squares(winding);
    const auto length = static_cast<float>(bend > 0 ? slope / bend : 0);
    for (std::size_t i = 0; i < n; ++i) area[i] += descent[i] * length;
    sums_.gradient(area, width, outward);
    for (std::size_t i = 0; i < n; ++i) {
      const float steepness = norm(outward[i]);
      outward[i] = steepness > 0 ? outward[i] / steepness : Vec3f{};
      area[i] = outward[i] * norm(area[i]);
    }
  }
  return outward;
}

}  // namespace sansmesh::inline v1::detail
