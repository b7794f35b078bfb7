#include "sansmesh/points/orientation/winding_doubt.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1::detail {
namespace {

/// Total numbers of evaluation points and of source samples, over all parts.
constexpr std::size_t kWindingTests = 1500, kWindingSources = 10000;
/// Least number of samples of a part for a meaningful mean.
constexpr std::size_t kFewestOfPart = 200;
constexpr std::size_t kNearTests = 12;
/// Width of the smoothing in noise levels, or spacings of the sources.
constexpr double kSmoothed = 2;
/// Largest relative deviation from the typical winding number.
constexpr double kOff = 0.5;

/// Every `step`-th entry of a list, starting in the middle of a step.
std::vector<std::uint32_t> every(const std::vector<std::uint32_t>& list, std::size_t step) {
  std::vector<std::uint32_t> some;
  for (std::size_t i = step / 2; i < list.size(); i += step) some.push_back(list[i]);
  return some;
}

/// Winding numbers up to a constant factor.
std::vector<double> winding_at(const RelationGraph& graph, const std::vector<std::uint32_t>& tests,
                               const std::vector<std::uint32_t>& sources, double width) {
  std::vector<double> winding(tests.size());
  parallel_for(0, tests.size(), 32, [&](std::size_t i) {
    const Vec3 x(graph.positions()[tests[i]]);
    double sum = 0;
    for (const std::uint32_t s : sources) {
      const Vec3 d = Vec3(graph.positions()[s]) - x;
      const double r2 = squared_norm(d) + width * width;
      sum += static_cast<double>(graph.area()[s]) * dot(Vec3(graph.normals()[s]), d) / (r2 * std::sqrt(r2));
    }
    winding[i] = sum;
  });
  return winding;
}

std::vector<double> mean_nearby(const RelationGraph& graph, const std::vector<std::uint32_t>& tests,
                                const std::vector<double>& values) {
  std::vector<Vec3f> positions;
  positions.reserve(tests.size());
  for (const std::uint32_t s : tests) positions.push_back(graph.positions()[s]);
  const KdTree tree(positions);
  std::vector<double> means(values.size());
  parallel_for(0, means.size(), 256, [&](std::size_t i) {
    std::array<Neighbour, kNearTests> near;
    const std::size_t n = tree.nearest(positions[i], near);
    for (std::size_t k = 0; k < n; ++k) means[i] += values[near[k].index] / static_cast<double>(n);
  });
  return means;
}

}  // namespace

double winding_doubt(const RelationGraph& graph, std::span<const std::uint32_t> part,
                     std::span<const std::uint8_t> open, double noise) {
  const std::size_t n = graph.size();
  if (n == 0) return 0;
  std::vector<std::vector<std::uint32_t>> members(open.size());
  for (std::size_t s = 0; s < n; ++s)
    if (!open[part[s]]) members[part[s]].push_back(static_cast<std::uint32_t>(s));
  const std::size_t step = 1 + n / kWindingTests, source_step = 1 + n / kWindingSources;
  std::vector<float> area = graph.area();
  const double spacing = std::sqrt(std::numbers::pi * static_cast<double>(median(area)) *
                                   static_cast<double>(source_step) / static_cast<double>(graph.degree()));
  const double width = kSmoothed * std::max(noise, spacing);
  double doubtful = 0;
  for (const std::vector<std::uint32_t>& of : members) {
    if (of.size() < kFewestOfPart) continue;
    // Small parts are evaluated more densely, so that there is a mean.
    const std::size_t own_step = std::min(step, of.size() / kFewestOfPart);
    const std::vector<std::uint32_t> tests = every(of, own_step);
    const std::vector<double> winding =
        mean_nearby(graph, tests, winding_at(graph, tests, every(of, std::min(source_step, own_step)), width));
    double sum = 0, squares = 0;
    for (const double w : winding) sum += w, squares += w * w;
    const double typical = sum != 0 ? squares / sum : 0;
    const auto off = static_cast<double>(std::count_if(winding.begin(), winding.end(), [&](double w) {
      return !(std::abs(w - typical) <= kOff * std::abs(typical));
    }));
    doubtful += off / static_cast<double>(tests.size()) * static_cast<double>(of.size());
  }
  return doubtful / static_cast<double>(n);
}

}  // namespace sansmesh::inline v1::detail
