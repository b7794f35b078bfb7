#include "sansmesh/points/ground/sided_plane.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sansmesh::inline v1 {
namespace {

/// Largest share of the values that deviations leave out: strays.
constexpr double kStrays = 0.1;
/// Parameters of a plane.
constexpr double kPlaneParameters = 3;
/// Least number of values in a half plane, and its distance beyond the point (spacings).
constexpr std::size_t kFewestOfSide = 8;
constexpr double kBeyondPlace = 0.5;
/// Half planes, and the largest share of the deviation of all values that one may have.
constexpr int kSides = 8;
constexpr double kBetterSide = 0.33;
/// The half plane counts in full from twice the least deviation on, and if its own is half of that share.
constexpr double kClearlyBetter = 2;
/// Weight of the nearest value, which shows the side of the point, beside the mean square of all.
constexpr double kNearestWeight = 0.5;

double distance_from(const LocalPlane& plane, const PlaneValue& v) {
  return v.z - plane.height - plane.rise_x * v.x - plane.rise_y * v.y;
}

}  // namespace

double SidedPlanes::deviation_from(const LocalPlane& plane, std::span<const PlaneValue> values) {
  squares_.clear();
  for (const PlaneValue& v : values) {
    const double e = distance_from(plane, v);
    squares_.push_back({e * e, v.weight});
  }
  std::sort(squares_.begin(), squares_.end());
  const auto strays = static_cast<std::size_t>(std::ceil(kStrays * static_cast<double>(squares_.size())));
  squares_.resize(std::max(squares_.size() - strays, (squares_.size() + 1) / 2));
  double sum = 0, weights = 0;
  for (const auto& [square, weight] : squares_) sum += weight * square, weights += weight;
  const auto n = static_cast<double>(squares_.size());
  return std::sqrt(sum / weights * n / std::max(1.0, n - kPlaneParameters));
}

double SidedPlanes::deviation(std::span<const PlaneValue> values) {
  return deviation_from(fit_local_plane(values, unit_, scratch_), values);
}

double SidedPlanes::height(std::span<const PlaneValue> values, double least) {
  const LocalPlane all = fit_local_plane(values, unit_, scratch_);
  const double deviation = deviation_from(all, values);
  if (deviation <= least) return all.height;
  const PlaneValue& nearest = *std::min_element(values.begin(), values.end(), [](const auto& a, const auto& b) {
    return a.x * a.x + a.y * a.y < b.x * b.x + b.y * b.y;
  });
  double height = all.height, best = kBetterSide * deviation;
  const double limit = best;
  for (int k = 0; k < kSides; ++k) {
    const double angle = 2 * std::numbers::pi * k / kSides, c = std::cos(angle), s = std::sin(angle);
    side_.clear();
    for (const PlaneValue& v : values)
      if (c * v.x + s * v.y > -kBeyondPlace * unit_) side_.push_back(v);
    if (side_.size() < kFewestOfSide) continue;
    const LocalPlane plane = fit_local_plane(side_, unit_, scratch_);
    const double of_side =
        std::hypot(deviation_from(plane, side_), std::sqrt(kNearestWeight) * distance_from(plane, nearest));
    if (of_side >= best) continue;
    best = of_side;
    // A plane may not exceed its values: they are on one side of the point.
    const auto [low, high] =
        std::minmax_element(side_.begin(), side_.end(), [](const auto& a, const auto& b) { return a.z < b.z; });
    height = std::clamp(plane.height, low->z - best, high->z + best);
  }
  // No height may hang on which side of a limit a deviation is.
  const double stepped = std::min(1.0, deviation / least - 1),
               better = std::min(1.0, kClearlyBetter * (1 - best / limit));
  return all.height + stepped * better * (height - all.height);
}

}  // namespace sansmesh::inline v1
