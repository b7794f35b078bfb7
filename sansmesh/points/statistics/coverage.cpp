#include "sansmesh/points/statistics/coverage.h"

#include <algorithm>
#include <limits>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/points/statistics/spacing.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

/// Reach of a sample over the local spacing: among random samples, one in ten million has all its neighbours so far to
/// one side that it counts as a border.
constexpr double kReachOverSpacing = 3;
/// One-sidedness half a spacing beyond a straight border.
constexpr double kOneSided = 0.42;
/// Border samples have a one-sidedness above the first value; the surface ends this many reaches away from their
/// neighbours (second value).
constexpr float kAtBorder = 0.1f, kBeyond = 0.45f;

/// One-sidedness a tenth of a reach beyond a straight border; not reached around a hole narrower than two reaches.
constexpr double kAlongBorder = 0.35;
/// Edge of the thinning lattice (one sample per cell), relative to the least local spacing.
constexpr double kThinned = 0.5;
/// Number per reach of the samples that close wide holes.
constexpr double kWideSamples = 6;

/// First sample in each cell of a lattice, in the order of the cells.
std::vector<Vec3f> thinned(std::span<const Vec3f> samples, double cell) {
  Box3f box;
  for (const Vec3f& p : samples) box.extend(p);
  std::vector<KeyIndex> cells(samples.size());
  static constexpr std::uint64_t kMostCells = 2097151;  // 21 bits per axis
  const Vec3 size(box.size());
  const double edge = std::max(cell, std::max({size.x, size.y, size.z}) / kMostCells);
  parallel_for(0, samples.size(), 16384, [&](std::size_t i) {
    const Vec3 p = Vec3(samples[i] - box.lower) * (1 / edge);
    const auto at = [](double v) { return index_in<std::uint64_t>(v, 0, kMostCells); };
    cells[i] = {at(p.x) << 42 | at(p.y) << 21 | at(p.z), static_cast<std::uint32_t>(i)};
  });
  parallel_sort(cells);
  std::vector<Vec3f> first;
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (i == 0 || cells[i].key != cells[i - 1].key) first.push_back(samples[cells[i].index]);
  return first;
}

}  // namespace

Coverage::Coverage(std::span<const Vec3f> samples, double spacing, std::optional<double> fill) {
  // Removes redundant samples where they are much denser than elsewhere.
  const KdTree tree(thinned(samples, kThinned * kLeastLocal * spacing));
  all_.samples = tree.positions();
  all_.reach.resize(all_.samples.size());
  const std::size_t k = std::min(kLocalNeighbours + 1, all_.samples.size());
  tree.for_each_nearest(k, [&](std::uint32_t slot, std::span<const Neighbour> found) {
    const auto last = static_cast<double>(found.empty() ? 0 : found.back().squared_distance);
    all_.reach[slot] = static_cast<float>(kReachOverSpacing * local_spacing(last, spacing));
  });
  build(samples, fill.value_or(0), kLeastLocal * spacing);
}

Coverage::Coverage(std::span<const Vec3f> points, std::span<const float> spacings, std::optional<double> fill) {
  const KdTree tree(points);
  all_.samples = tree.positions();
  for (const std::uint32_t i : tree.order()) all_.reach.push_back(static_cast<float>(kReachOverSpacing) * spacings[i]);
  build(points, fill.value_or(0), 0);
}

void Coverage::build(std::span<const Vec3f> samples, double fill, double least) {
  all_.tree = BallTree(all_.samples, all_.reach);
  if (const double reach = 0.5 * fill; reach > kReachOverSpacing * least) {
    wide_.emplace();
    wide_->samples = KdTree(thinned(samples, reach / kWideSamples)).positions();
    wide_->reach.assign(wide_->samples.size(), static_cast<float>(reach));
    wide_->tree = BallTree(wide_->samples, wide_->reach);
  }
  for (const Layer* layer : {&all_, wide_ ? &*wide_ : nullptr})
    for (std::size_t i = 0; layer && i < layer->samples.size(); ++i) {
      const Vec3 r = Vec3{1, 1, 1} * static_cast<double>(layer->reach[i]), x(layer->samples[i]);
      bounds_.extend(x - r), bounds_.extend(x + r);
    }
}

Vec3f Coverage::Layer::to_samples(const Vec3f& x, std::vector<std::uint32_t>& near) const {
  tree.touching({x, x}, near);
  Vec3f sum;
  float weight = 0;
  for (const std::uint32_t i : near) {
    const Vec3f d = (samples[i] - x) / reach[i];
    const float inside = 1 - squared_norm(d);
    if (!(inside > 0)) continue;
    sum += d * (inside * inside), weight += inside * inside;
  }
  // Out of reach of all samples: only the sign matters, the contour is far away.
  return weight > 0 ? sum / weight : Vec3f{1, 0, 0};
}

bool Coverage::Layer::reaches(const Box3f& box, std::vector<std::uint32_t>& near) const {
  return !tree.touching(box, 1, near) || !near.empty();
}

double Coverage::value(const Vec3f& x, std::vector<std::uint32_t>& near) const {
  const double value = static_cast<double>(norm(all_.to_samples(x, near))) - kOneSided;
  if (!wide_ || value < 0) return value;
  return std::min(value, static_cast<double>(norm(wide_->to_samples(x, near))) - kAlongBorder);
}

void Coverage::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
  parallel_ranges(0, x.size(), 512, [&](std::size_t first, std::size_t last) {
    std::vector<std::uint32_t> near;
    for (std::size_t i = first; i < last; ++i) values[i] = value(Vec3f(x[i]), near);
  });
  std::fill(gradients.begin(), gradients.end(), Vec3{});
}

void Coverage::ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  parallel_ranges(0, x.size(), 512, [&](std::size_t first, std::size_t last) {
    std::vector<std::uint32_t> near;
    for (std::size_t i = first; i < last; ++i) {
      const auto r = static_cast<float>(radius);
      const Vec3f p(x[i]), half{r, r, r};
      const Box3f box{p - half, p + half};
      const bool any = all_.reaches(box, near) || (wide_ && wide_->reaches(box, near));
      found[i] = any ? ValueRange{-kInfinity, kInfinity} : ValueRange{1 - kOneSided, kInfinity};
    }
  });
}

std::vector<Coverage::Border> Coverage::borders() const {
  const std::vector<Vec3f>& samples = all_.samples;
  std::vector<std::uint8_t> at_border(samples.size());
  std::vector<Vec3f> to_others(samples.size());
  parallel_ranges(0, samples.size(), 512, [&](std::size_t first, std::size_t last) {
    std::vector<std::uint32_t> near;
    for (std::size_t i = first; i < last; ++i) {
      const Vec3f inward = all_.to_samples(samples[i], near);
      const float size = norm(inward);
      if (!(size > kAtBorder)) continue;
      to_others[i] = inward / size;
      at_border[i] = value(samples[i] - inward * (kBeyond * all_.reach[i] / size), near) > 0;
    }
  });
  std::vector<Border> borders;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (at_border[i])
      borders.push_back(
          {samples[i], all_.reach[i], all_.reach[i] / static_cast<float>(kReachOverSpacing), to_others[i]});
  return borders;
}

}  // namespace sansmesh::inline v1
