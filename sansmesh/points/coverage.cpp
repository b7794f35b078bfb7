#include "sansmesh/points/coverage.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "sansmesh/core/parallel.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh {
namespace {

/// The local spacing is that of so many neighbours: a line of a scanner, whose own points are close together, then has
/// some of the next lines among them.
constexpr std::size_t kLocalNeighbours = 16;
/// Reach of a sample over the local spacing: of samples placed at random, one in ten million has all others so far to
/// one side that it would count as a border.
constexpr double kReachOverSpacing = 3;
/// The local spacing counts as no less than this share of the mean, and no more than so many times that (strays).
constexpr double kLeastLocal = 0.5, kMostLocal = 12;
/// One-sidedness half a spacing beyond a straight border.
constexpr double kOneSided = 0.42;
/// A sample lies at a border if it sees others a little to one side, and so many reaches away from them the surface has
/// ended.
constexpr float kAtBorder = 0.1f, kBeyond = 0.45f;

}  // namespace

Coverage::Coverage(std::span<const Vec3f> samples, double spacing, std::optional<double> fill) {
  const KdTree tree(samples);
  samples_ = tree.positions();
  reach_.resize(samples_.size());
  const std::size_t k = std::min(kLocalNeighbours + 1, samples_.size());
  const double least = kLeastLocal * spacing, most = kMostLocal * spacing;
  const double of_distance = std::sqrt(std::numbers::pi / static_cast<double>(kLocalNeighbours));
  tree.for_each_nearest(k, [&](std::uint32_t slot, std::span<const Neighbour> found) {
    const double local =
        of_distance * std::sqrt(static_cast<double>(found.empty() ? 0 : found.back().squared_distance));
    reach_[slot] =
        static_cast<float>(std::max(kReachOverSpacing * std::clamp(local, least, most), 0.5 * fill.value_or(0)));
  });
  tree_ = BallTree(samples_, reach_);
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const Vec3 r = Vec3{1, 1, 1} * static_cast<double>(reach_[i]), x(samples_[i]);
    bounds_.extend(x - r), bounds_.extend(x + r);
  }
}

Vec3f Coverage::to_samples(const Vec3f& x, std::vector<std::uint32_t>& near) const {
  tree_.touching({x, x}, near);
  Vec3f sum;
  float weight = 0;
  for (const std::uint32_t i : near) {
    const Vec3f d = (samples_[i] - x) / reach_[i];
    const float inside = 1 - squared_norm(d);
    if (!(inside > 0)) continue;
    sum += d * (inside * inside), weight += inside * inside;
  }
  // Out of reach of all: what matters is that it is outside; the contour is far.
  return weight > 0 ? sum / weight : Vec3f{1, 0, 0};
}

void Coverage::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
  parallel_ranges(0, x.size(), 512, [&](std::size_t first, std::size_t last) {
    std::vector<std::uint32_t> near;
    for (std::size_t i = first; i < last; ++i)
      values[i] = static_cast<double>(norm(to_samples(Vec3f(x[i]), near))) - kOneSided;
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
      const bool any = !tree_.touching({p - half, p + half}, 1, near) || !near.empty();
      found[i] = any ? ValueRange{-kInfinity, kInfinity} : ValueRange{1 - kOneSided, kInfinity};
    }
  });
}

std::vector<Coverage::Border> Coverage::borders() const {
  std::vector<std::uint8_t> at_border(samples_.size());
  parallel_ranges(0, samples_.size(), 512, [&](std::size_t first, std::size_t last) {
    std::vector<std::uint32_t> near;
    for (std::size_t i = first; i < last; ++i) {
      const Vec3f inward = to_samples(samples_[i], near);
      const float size = norm(inward);
      if (!(size > kAtBorder)) continue;
      const Vec3f beyond = samples_[i] - inward * (kBeyond * reach_[i] / size);
      at_border[i] = static_cast<double>(norm(to_samples(beyond, near))) > kOneSided;
    }
  });
  std::vector<Border> borders;
  for (std::size_t i = 0; i < samples_.size(); ++i)
    if (at_border[i]) borders.push_back({samples_[i], reach_[i], reach_[i] / static_cast<float>(kReachOverSpacing)});
  return borders;
}

}  // namespace sansmesh
