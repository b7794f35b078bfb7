// What the far field lies between in a ball: its sums term by term, each bounded over the ball.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "sansmesh/partition/global_sign.h"

namespace sansmesh {
namespace {

/// Balls that more groups than this are too close to be bounded by as one each: nothing is said of the values.
constexpr std::size_t kMostGroups = 1500;
/// Patches within so many radii of the ball's middle count as near ones: of their part in the mean square distance only
/// the largest is taken, since its numerator and denominator would be bounded apart.
constexpr double kNear = 4;

struct Ends {
  double low = 0, high = 0;
  void operator+=(const Ends& b) { low += b.low, high += b.high; }
  /// Of what is anything between the two.
  static Ends between(const Ends& a, const Ends& b) { return {std::min(a.low, b.low), std::max(a.high, b.high)}; }
};

/// Bounds over a ball for the sums of the far field, as it forms them.
struct BoundedSums {
  Ends dipole, fourth, sixth;
  double beyond = 0;                     ///< of `fourth`, at most: the part of patches that are not near
  double nearest = 1e300, farthest = 0;  ///< squared distances: of all patches, of the near ones

  void operator+=(const BoundedSums& b) {
    dipole += b.dipole, fourth += b.fourth, sixth += b.sixth;
    beyond += b.beyond;
    nearest = std::min(nearest, b.nearest), farthest = std::max(farthest, b.farthest);
  }
  static BoundedSums between(const BoundedSums& a, const BoundedSums& b) {
    return {Ends::between(a.dipole, b.dipole), Ends::between(a.fourth, b.fourth), Ends::between(a.sixth, b.sixth),
            std::max(a.beyond, b.beyond),      std::min(a.nearest, b.nearest),    std::max(a.farthest, b.farthest)};
  }
};

/// One walk down the tree for one ball.
struct Bounder {
  const std::vector<std::vector<GlobalSign::Octet>>& levels;
  Vec3 center;
  double radius;
  std::size_t groups = 0;

  /// A patch, or a group as one.
  BoundedSums alone(const GlobalSign::Octet& o, std::size_t k, const Vec3& step, double soft, double near,
                    double far) const {
    const Vec3 area{o.ax[k], o.ay[k], o.az[k]};
    const double a = norm(area), weight = o.area[k];
    const double low2 = std::max(near * near + soft, 1e-12), high2 = std::max(far * far + soft, 1e-12);
    const double low = std::sqrt(low2), high = std::sqrt(high2);
    BoundedSums s;
    // ⟨p − y, a⟩ changes by |a| a step, 1/r³ falls; and the gradient of their product is 2 |a| / r³ at most.
    const double dot_low = dot(step, area) - a * radius, dot_high = dot(step, area) + a * radius;
    const double cube_low = 1 / (high * high2), cube_high = 1 / (low * low2);
    s.dipole = {dot_low * (dot_low < 0 ? cube_high : cube_low), dot_high * (dot_high > 0 ? cube_high : cube_low)};
    const double middle2 = std::max(squared_norm(step) + soft, 1e-12);
    const double middle = dot(step, area) / (middle2 * std::sqrt(middle2)), change = 2 * a * radius * cube_high;
    s.dipole.low = std::max({s.dipole.low, middle - change, -a / low2});
    s.dipole.high = std::min({s.dipole.high, middle + change, a / low2});
    if (norm(step) > radius) {
      // From anywhere in the ball the patch is seen in directions of a cone around the one from the middle.
      const double sine = radius / norm(step), cosine = std::sqrt(1 - sine * sine);
      const double facing = a > 0 ? std::clamp(dot(step, area) / (norm(step) * a), -1.0, 1.0) : 0;
      const double across = std::sqrt(1 - facing * facing) * sine;
      const double least = facing > -cosine ? facing * cosine - across : -1;
      const double most = facing < cosine ? facing * cosine + across : 1;
      // r / (r² + soft)^(3/2) first grows, then falls: smallest at one of the ends.
      const double size = a * std::min(near / (low2 * low), far / (high2 * high));
      if (least > 0) s.dipole.low = std::max(s.dipole.low, least * size);
      if (most < 0) s.dipole.high = std::min(s.dipole.high, most * size);
    }
    s.fourth = {weight / (high2 * high2), weight / (low2 * low2)};
    s.sixth = {weight / (high2 * high2 * high2), weight / (low2 * low2 * low2)};
    s.nearest = low2;
    if (squared_norm(step) < kNear * kNear * radius * radius)
      s.farthest = high2;
    else
      s.beyond = s.fourth.high;
    return s;
  }

  BoundedSums members(std::size_t level, std::size_t octet) {
    BoundedSums sum;
    const GlobalSign::Octet& o = levels[level][octet];
    for (std::size_t k = 0; k < 8; ++k) {
      if (o.radius[k] < 0) continue;
      if (++groups > kMostGroups) return sum;
      const Vec3 step = Vec3{o.x[k], o.y[k], o.z[k]} - center;
      const double distance = norm(step), near = std::max(0.0, distance - radius), far = distance + radius;
      if (level == 0) {
        sum += alone(o, k, step, 0.25 * static_cast<double>(o.area[k]), near, far);
        continue;
      }
      const double size = std::max(static_cast<double>(o.radius[k]) * static_cast<double>(o.radius[k]), 1e-20);
      // A little wider than evaluation is, for its rounding.
      const bool counts = far * far > 0.999 * GlobalSign::kOpen * size;
      const bool opened = near * near < 1.001 * GlobalSign::kClosed * size;
      if (counts && opened) {
        sum += BoundedSums::between(alone(o, k, step, 0, near, far), members(level - 1, 8 * octet + k));
      } else {
        sum += opened ? members(level - 1, 8 * octet + k) : alone(o, k, step, 0, near, far);
      }
    }
    return sum;
  }
};

}  // namespace

ValueRange GlobalSign::range(const Vec3f& x, float radius) const {
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  if (empty()) return {0, 0};
  const double unit = unit_, reach = static_cast<double>(radius) / unit;
  // Far away values grow in proportion to the distance: of no use to anybody.
  if (!(norm(Vec3(x)) / unit + reach < kFarthest)) return {-kUnknown, kUnknown};
  Bounder bounder{levels_, Vec3(x) / unit, reach};
  const BoundedSums s = bounder.members(levels_.size() - 1, 0);
  if (bounder.groups > kMostGroups) return {-kUnknown, kUnknown};
  // d² is half a mean of r² with the weights area / r⁶.
  const double low2 = std::max(0.5 * s.nearest, 0.5 * s.fourth.low / s.sixth.high);
  const double high2 = std::min(0.5 * s.fourth.high / s.sixth.low, 0.5 * (s.farthest + s.beyond / s.sixth.low));
  const Ends distance{std::sqrt(low2) * unit, std::sqrt(std::max(low2, high2)) * unit};
  const auto sign = [](double dipole) { return std::clamp(1 - dipole / (2 * std::numbers::pi), -1.0, 1.0); };
  const Ends inside{sign(s.dipole.high), sign(s.dipole.low)};
  return {inside.low * (inside.low > 0 ? distance.low : distance.high),
          inside.high * (inside.high < 0 ? distance.low : distance.high)};
}

}  // namespace sansmesh
