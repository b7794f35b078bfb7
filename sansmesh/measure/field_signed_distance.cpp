#include <algorithm>
#include <cmath>

#include "sansmesh/measure/signed_distance.h"

namespace sansmesh {
namespace {

constexpr int kNewtonSteps = 40;     // of one way to the zero set
constexpr int kFootSteps = 12;       // corrections within the tangent plane
constexpr double kOnSurface = 1e-9;  // of the box's diagonal
constexpr double kSettled = 1e-5;    // of the distance: shortest correction; its effect on the distance is the square

/// Values and gradients of some of many points.
class Evaluation {
 public:
  Evaluation(const ScalarField& field, std::size_t count)
      : field_(field), values_(count), gradients_(count), inside_(count) {}

  void at(const std::vector<Vec3>& points, const std::vector<std::uint32_t>& which) {
    x_.clear();
    for (const std::uint32_t i : which) x_.push_back(points[i]);
    found_.resize(x_.size()), slopes_.resize(x_.size()), domain_.resize(x_.size());
    field_.evaluate_in_domain(x_, found_, slopes_, domain_);
    for (std::size_t k = 0; k < which.size(); ++k) {
      values_[which[k]] = found_[k];
      gradients_[which[k]] = slopes_[k];
      inside_[which[k]] = domain_[k];
    }
  }
  double value(std::size_t i) const { return values_[i]; }
  const Vec3& gradient(std::size_t i) const { return gradients_[i]; }
  bool inside(std::size_t i) const { return inside_[i] != 0; }

 private:
  const ScalarField& field_;
  std::vector<double> values_;
  std::vector<Vec3> gradients_;
  std::vector<std::uint8_t> inside_;
  std::vector<Vec3> x_, slopes_;
  std::vector<double> found_;
  std::vector<std::uint8_t> domain_;
};

}  // namespace

void FieldDistance::measure(std::span<const Vec3> x, double farthest, std::span<MeasuredPoint> found) const {
  const std::size_t n = x.size();
  const double tolerance = kOnSurface * field_.bounds().diagonal();
  // Steps are short enough that a nearly flat place does not throw a point across the surface and away, and the way may
  // be somewhat longer than the straight line in the end.
  const double longest = 0.5 * farthest, reach = 1.5 * farthest;
  std::vector<Vec3> at(x.begin(), x.end()), tried;
  Evaluation f(field_, n);
  std::vector<std::uint32_t> ready, open, next;
  for (std::size_t i = 0; i < n; ++i) {
    found[i] = {};
    if (is_finite(x[i])) open.push_back(static_cast<std::uint32_t>(i));
  }
  std::vector<double> sign(n, 1);

  // Moves the points of `open` onto the zero set; those that arrive are appended to `ready`.
  const auto descend = [&](std::vector<Vec3>& points, bool first) {
    ready.clear();
    for (int step = 0; step <= kNewtonSteps && !open.empty(); ++step) {
      f.at(points, open);
      next.clear();
      for (const std::uint32_t i : open) {
        const double value = f.value(i), slope = squared_norm(f.gradient(i));
        if (first && step == 0) sign[i] = value < 0 ? -1 : 1;
        if (!(slope > 0) || !std::isfinite(value) || !std::isfinite(slope)) continue;
        Vec3 move = f.gradient(i) * (-value / slope);
        const double length = norm(move);
        if (length <= tolerance) {
          if (f.inside(i)) ready.push_back(i);
          continue;
        }
        if (length > longest) move *= longest / length;
        points[i] += move;
        if (norm(points[i] - x[i]) <= reach) next.push_back(i);
      }
      open.swap(next);
    }
  };

  descend(at, true);
  std::vector<Vec3> normals(n);
  std::vector<double> share(n, 1);
  std::vector<std::uint8_t> arrived(n);
  std::vector<std::uint32_t> moving = ready;
  const auto settle = [&](std::uint32_t i, const Vec3& foot) {
    at[i] = foot;
    normals[i] = normalized(f.gradient(i));
    found[i] = {sign[i] * norm(x[i] - foot), foot, false};
  };
  const auto aside = [&](std::uint32_t i, const Vec3& foot, const Vec3& normal) {
    const Vec3 line = x[i] - foot;
    return line - normal * dot(line, normal);
  };
  for (const std::uint32_t i : moving) settle(i, at[i]);
  for (int step = 0; step < kFootSteps && !moving.empty(); ++step) {
    tried = at;
    open.clear();
    for (const std::uint32_t i : moving) {
      const Vec3 move = aside(i, at[i], normals[i]);
      arrived[i] = 0;
      if (norm(move) <= kSettled * norm(x[i] - at[i]) || norm(move) <= tolerance) continue;
      tried[i] += move * share[i];
      open.push_back(i);
    }
    moving = open;
    descend(tried, false);
    for (const std::uint32_t i : ready) arrived[i] = 1;
    for (const std::uint32_t i : moving) {
      if (!arrived[i]) {
        share[i] *= 0.25;
        continue;
      }
      // How much of the deviation is left tells how long the step should have been: the surface's curvature decides,
      // and a whole one goes too far outside of convex places and not far enough inside.
      const Vec3 before = aside(i, at[i], normals[i]), after = aside(i, tried[i], normalized(f.gradient(i)));
      const double left = dot(before, after) / squared_norm(before);
      share[i] *= std::clamp(1 / std::max(0.1, 1 - left), 0.1, 4.0);
      if (norm(x[i] - tried[i]) < norm(x[i] - at[i])) settle(i, tried[i]);
    }
  }
  for (std::size_t i = 0; i < n; ++i)
    if (std::abs(found[i].distance) > farthest) found[i] = {};
}

}  // namespace sansmesh
