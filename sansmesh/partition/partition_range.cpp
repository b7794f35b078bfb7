// Bounds of the function in a ball. F is a mean of the local functions that reach the ball and of the far field, so
// between the smallest and the largest of their values. The slopes of local functions are known; if some are positive
// and some are negative, bounds of their weights may still determine the sign. No useful bound of the far field's slope
// is known (bounded patch by patch, it takes a thousand times as long as a value, and is inconclusive at most points
// inside of solids): a measured slope with a margin replaces it.
#include "sansmesh/partition/partition_range.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();
constexpr ValueRange kNothing{-kUnknown, kUnknown};

/// Slope assumed for the far field. Of 5 million gradients, between and around the supports of scans, parts, thin
/// shapes and depth frames, 999 of 1000 are shorter than 2.1, and the longest is 4.1.
constexpr double kFarSlope = 5;
/// The same with open sheets: the planes of two that face the same way contradict each other between them, where slopes
/// of 6 have been found.
constexpr double kOpenFarSlope = 10;

/// Balls that more supports than this reach are too large for useful bounds.
constexpr std::size_t kMostSupports = 400;
/// Evaluation is in single precision. Balls are widened by these shares of the cube's edge and of the distance from the
/// origin, ranges by this share of the largest radius and of the values.
constexpr double kRoundedPosition = 1e-6, kRoundedFar = 0x1p-22, kRoundedValue = 4e-6;

/// Smallest ball around the intersection of the balls around `a` and `b`, and the range of distances from `a` in it.
struct Common {
  Vec3 center;
  double radius, nearest, farthest;

  Common(const Vec3& a, double ra, const Vec3& b, double rb, double distance)
      : nearest(std::max(0.0, distance - rb)), farthest(std::min(ra, distance + rb)) {
    // Position of the spheres' intersection, from a towards b.
    const double along =
        distance > 0 ? (distance * distance + ra * ra - rb * rb) / (2 * distance) : (ra < rb ? -1 : 1) * kUnknown;
    if (!(along > 0)) {
      center = a, radius = ra;
    } else if (!(along < distance)) {
      center = b, radius = rb;
    } else {
      center = a + (b - a) * (along / distance);
      radius = std::sqrt(std::max(0.0, ra * ra - along * along));
    }
  }
};

double power4(double x) { return x * x * x * x; }

/// Flattening of values as in evaluation: the identity near 0, (1 + straight) / 2 radii from one radius on.
double flattened(double value, double straight, double radius) {
  const double size = std::min(std::abs(value) / radius, 1.0), excess = std::max(0.0, size - straight);
  return std::copysign((size - excess * excess / (2 * (1 - straight))) * radius, value);
}

/// Factor of the weight where |f| is `size` radii.
double near_factor(double size, double trusted) {
  return power4(std::max(0.0, 1 - std::max(0.0, size * size - trusted) / (1 - trusted)));
}

/// Range of one piece within a ball, as in evaluation.
ValueRange piece_range(const PartitionState& s, std::size_t i, const Vec3& center, double radius) {
  const LocalFunction& f = s.data.functions[i];
  const double value = static_cast<double>(local_value(f, Vec3f(center)));
  const double slope = static_cast<double>(s.data.slopes[i]);
  ValueRange r{value - slope * radius, value + slope * radius};
  // The value is divided by the length of the gradient, which is between 1 and its bound.
  if ((s.manner[i] & kNormalised) != 0) {
    if (r.least > 0) r.least /= slope;
    if (r.most < 0) r.most /= slope;
  }
  return r;
}

/// Sums over the supports that reach a ball: of their weights, of weight times value, and the range of the values.
struct NearSums {
  ValueRange values{kUnknown, -kUnknown};
  double weight_low = 0, weight_high = 0, low = 0, high = 0, largest = 0;

  void add(const PartitionState& s, std::uint32_t i, const Vec3& x, double radius) {
    const LocalFunction& f = s.data.functions[i];
    const Vec3 center(f.center);
    const auto size = static_cast<double>(f.radius);
    const double distance = norm(x - center);
    if (distance >= size + radius) return;
    const Common common(center, size, x, radius, distance);
    const double far = common.farthest / size, near = common.nearest / size;
    double theta_low = distance + radius < size ? power4(1 - far * far) : 0, theta_high = power4(1 - near * near);
    ValueRange v = piece_range(s, i, common.center, common.radius);
    for (const LocalFunction* g = &f; g->next != 0;) {
      const auto next = static_cast<std::size_t>(g->next - 1);
      const ValueRange w = piece_range(s, next, common.center, common.radius);
      v = g->convex != 0 ? ValueRange{std::max(v.least, w.least), std::max(v.most, w.most)}
                         : ValueRange{std::min(v.least, w.least), std::min(v.most, w.most)};
      g = &s.data.functions[next];
    }
    const std::uint8_t manner = s.manner[i];
    if ((manner & kNormalised) != 0 && f.next == 0) {
      const auto slope = static_cast<double>(s.data.slopes[i]);
      theta_low /= slope * slope;
    }
    if ((manner & kPlain) != 0) {
      // Values and weights are unchanged.
    } else if (!f.is_constant()) {
      const bool close = (manner & kClose) != 0;
      const auto trusted = static_cast<double>(close ? kTrustedClose : kTrusted),
                 straight = static_cast<double>(close ? kStraightClose : kStraight);
      const double least = v.holds_zero() ? 0 : std::min(std::abs(v.least), std::abs(v.most));
      theta_low *= near_factor(std::max(std::abs(v.least), std::abs(v.most)) / size, trusted);
      theta_high *= near_factor(least / size, trusted);
      v = {flattened(v.least, straight, size), flattened(v.most, straight, size)};
    } else {
      v = {std::clamp(v.least, -size, size), std::clamp(v.most, -size, size)};
    }
    if (theta_high == 0) return;
    values.least = std::min(values.least, v.least), values.most = std::max(values.most, v.most);
    weight_low += theta_low, weight_high += theta_high;
    low += v.least * (v.least > 0 ? theta_low : theta_high);
    high += v.most * (v.most < 0 ? theta_low : theta_high);
    largest = std::max(largest, size);
  }

  /// Range of the weighted mean. If the bounds of the sum have one sign, so has the mean.
  ValueRange mean() const {
    ValueRange r = values;
    if (low > 0) r.least = std::max(r.least, low / weight_high);
    if (high < 0) r.most = std::min(r.most, high / weight_high);
    if (low < 0 && weight_low > 0) r.least = std::max(r.least, low / weight_low);
    if (high > 0 && weight_low > 0) r.most = std::min(r.most, high / weight_low);
    return r;
  }
};

/// Range of the local functions in a ball, and whether the far field has a share there.
struct NearRange {
  ValueRange range;
  bool with_far;
  double largest;  ///< largest radius of those supports
};

NearRange near_range(const PartitionState& s, const Vec3& x, double radius, std::vector<std::uint32_t>& list) {
  const Vec3f center(x), reach = Vec3f{1, 1, 1} * static_cast<float>(radius);
  if (!s.tree.touching({center - reach, center + reach}, kMostSupports, list)) return {kNothing, false, 0};
  NearSums sums;
  for (const std::uint32_t i : list) sums.add(s, i, x, radius);
  // The far field has no share at weights above kFadeWeight.
  return {sums.mean(), sums.weight_low < 1.001 * static_cast<double>(s.full), sums.largest};
}

/// Processes batches of points sequentially on one thread.
struct Batch {
  std::vector<std::uint32_t> list;
  std::vector<std::size_t> at;
  std::vector<Vec3f> centers;
  std::vector<double> reach;
  std::vector<float> values;

  void find(const PartitionState& s, std::span<const Vec3> x, double radius, std::span<ValueRange> found) {
    at.clear(), centers.clear(), reach.clear();
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Vec3 p = x[i] - s.data.origin;
      const double wide = radius + kRoundedPosition * static_cast<double>(s.data.edge) + kRoundedFar * norm(p);
      found[i] = kNothing;
      if (!std::isfinite(wide) || !is_finite(p)) continue;
      const NearRange near = near_range(s, p, wide, list);
      found[i] = widened(near.range, kRoundedValue * near.largest);
      if (!near.with_far) continue;
      at.push_back(i), centers.push_back(Vec3f(p));
      reach.push_back((s.far.open.empty() ? kFarSlope : kOpenFarSlope) * wide);
    }
    values.resize(at.size());
    s.far.signed_distance(centers, values);
    for (std::size_t j = 0; j < at.size(); ++j) {
      const double value = static_cast<double>(values[j]);
      ValueRange& r = found[at[j]];
      r = {std::min(r.least, value - reach[j]), std::max(r.most, value + reach[j])};
    }
    for (ValueRange& r : found) r = widened(r, kRoundedValue * std::max(std::abs(r.least), std::abs(r.most)));
  }

  static ValueRange widened(const ValueRange& r, double by) { return {r.least - by, r.most + by}; }
};

}  // namespace

void partition_ranges(const PartitionState& s, std::span<const Vec3> x, double radius, std::span<ValueRange> found) {
  parallel_ranges(0, x.size(), 128, [&](std::size_t first, std::size_t last) {
    Batch batch;
    batch.find(s, x.subspan(first, last - first), radius, found.subspan(first, last - first));
  });
}

}  // namespace sansmesh::inline v1
