#include "sansmesh/measure/field_signed_distance.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace sansmesh::inline v1 {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr int kSteps = 80;        // per search of the zero set: enough to bisect from the box's size to kNoise
constexpr int kFootSteps = 12;    // corrections in the tangent plane
constexpr double kExact = 1e-9;   // shortest step, relative to the box's diagonal
constexpr double kNoise = 1e-6;   // relative to the diagonal: limit of fields with float values
constexpr double kShrinks = 0.9;  // a step above this share of the best one is noise
constexpr double kSettled =
    1e-5;  // shortest correction, relative to the distance; its effect on the distance is quadratic
constexpr double kFarOff = 0.02;     // relative to the diagonal: above it the line to the foot is tested
constexpr int kLooks = 8;            // segments of that line
constexpr double kLongStep = 0.25;   // relative to the diagonal, inside the box
constexpr double kToTheBox = 0.9;    // share of the distance to the box, outside it
constexpr double kMuchLonger = 1.5;  // longest path, relative to the straight line

double distance_to_box(const Box3& box, const Vec3& p) {
  Vec3 out;
  for (std::size_t k = 0; k < 3; ++k) out[k] = std::max({box.lower[k] - p[k], p[k] - box.upper[k], 0.0});
  return norm(out);
}

enum class Way : std::uint8_t { open, arrived, beyond, lost };

/// One search for the zero set: its position, the bracket, and the point closest to the zero set so far.
struct Walk {
  Vec3 at;
  Vec3 inner, outer;  ///< the last points with a negative and another value: the surface is between them
  bool has_inner = false, has_outer = false;
  double last = kNever, before = kNever;  ///< lengths of the last two steps
  double best = kNever;                   ///< length of Newton's step from the foot
  Vec3 foot, normal;
  bool in_domain = false;  ///< state of the foot
  Way way = Way::open;
};

/// Feet of many points on the zero set, searched together so that the field is evaluated in batches.
class Feet {
 public:
  Feet(const ScalarField& field, std::span<const Vec3> x, double farthest)
      : field_(field),
        x_(x),
        box_(field.bounds()),
        scale_(std::isfinite(box_.diagonal()) ? box_.diagonal() : farthest),
        exact_(kExact * scale_),
        noise_(kNoise * scale_),
        longest_(0.5 * farthest),
        reach_(kMuchLonger * farthest),
        walks_(x.size()),
        sign_(x.size(), 1),
        feet_(x.size()),
        normals_(x.size()),
        ways_(x.size(), Way::open) {}

  void find() {
    approach();
    look_between();
    settle();
  }

  MeasuredPoint result(std::size_t i, double farthest) const {
    if (ways_[i] == Way::lost) {
      MeasuredPoint nowhere;
      nowhere.lost = true;
      return nowhere;
    }
    const double distance = norm(x_[i] - feet_[i]);
    if (ways_[i] != Way::arrived || distance > farthest) return {};
    return {sign_[i] * distance, feet_[i], false, false};
  }

 private:
  void evaluate(const std::vector<Vec3>& at) {
    values_.resize(at.size()), gradients_.resize(at.size()), inside_.resize(at.size());
    field_.evaluate_in_domain(at, values_, gradients_, inside_);
  }

  void start(std::uint32_t i, const Vec3& at) {
    walks_[i] = {};
    walks_[i].at = at;
    open_.push_back(i);
  }

  /// Records the field at the position of a search. Returns whether the search ends.
  bool arrives(Walk& w, double value, const Vec3& gradient, bool in_domain) const {
    const double slope = norm(gradient), length = std::abs(value) / slope;
    const bool usable = slope > 0 && std::isfinite(slope);
    (value < 0 ? w.inner : w.outer) = w.at;
    (value < 0 ? w.has_inner : w.has_outer) = true;
    const bool closer = usable && length < kShrinks * w.best;
    if (usable && length < w.best) {
      w.best = length;
      w.foot = w.at, w.normal = gradient / slope, w.in_domain = in_domain;
    }
    // Near the zero set of a float function the steps stop shrinking: the rest is noise.
    if (w.best <= exact_ || (w.best <= noise_ && !closer)) return true;
    if (!w.has_inner || !w.has_outer || norm(w.outer - w.inner) > exact_) return false;
    // The bracket determines the position, however steep or rough the field is.
    if (w.best > noise_) {
      w.foot = w.at, w.in_domain = in_domain;
      w.normal = usable ? gradient / slope : normalized(w.outer - w.inner);
    }
    return true;
  }

  /// One step: Newton's if it is short enough, otherwise bisection.
  void step(Walk& w, const Vec3& x, double value, const Vec3& gradient) const {
    const double slope = squared_norm(gradient);
    const bool usable = slope > 0 && std::isfinite(slope), bracketed = w.has_inner && w.has_outer;
    Vec3 next = w.at;
    bool newton = usable;
    if (usable) {
      Vec3 move = gradient * (-value / slope);
      // Small gradients must not move it across the surface and away.
      const double length = norm(move);
      const double cap = std::min(longest_, kLongStep * scale_ + kToTheBox * distance_to_box(box_, w.at));
      if (length > cap) move *= cap / length;
      next += move;
      if (bracketed) newton = length <= norm(w.outer - w.inner) && length < 0.5 * w.before && norm(next - x) <= reach_;
    }
    if (!newton) {
      if (!bracketed) {
        w.way = Way::lost;
        return;
      }
      next = (w.inner + w.outer) * 0.5;
    }
    w.before = w.last;
    w.last = norm(next - w.at);
    w.at = next;
    if (norm(next - x) > reach_) w.way = Way::beyond;
  }

  /// Completes the searches in open_.
  void walk() {
    std::vector<std::uint32_t> left;
    std::vector<Vec3> at;
    for (int count = 0; count < kSteps && !open_.empty(); ++count) {
      at.clear();
      for (const std::uint32_t i : open_) at.push_back(walks_[i].at);
      evaluate(at);
      left.clear();
      for (std::size_t k = 0; k < open_.size(); ++k) {
        Walk& w = walks_[open_[k]];
        if (!std::isfinite(values_[k]))
          w.way = Way::lost;
        else if (arrives(w, values_[k], gradients_[k], inside_[k] != 0))
          w.way = w.in_domain ? Way::arrived : Way::lost;
        else
          step(w, x_[open_[k]], values_[k], gradients_[k]);
        if (w.way == Way::open) left.push_back(open_[k]);
      }
      open_.swap(left);
    }
    for (const std::uint32_t i : open_)
      walks_[i].way = walks_[i].best <= noise_ && walks_[i].in_domain ? Way::arrived : Way::lost;
    open_.clear();
  }

  void keep(std::uint32_t i) {
    feet_[i] = walks_[i].foot;
    normals_[i] = walks_[i].normal;
  }

  /// Moves the points to the zero set.
  void approach() {
    std::vector<Vec3> at;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      if (!is_finite(x_[i])) continue;
      start(static_cast<std::uint32_t>(i), x_[i]);
      at.push_back(x_[i]);
    }
    evaluate(at);
    for (std::size_t k = 0; k < open_.size(); ++k) sign_[open_[k]] = values_[k] < 0 ? -1 : 1;
    const std::vector<std::uint32_t> all = open_;
    walk();
    for (const std::uint32_t i : all) {
      ways_[i] = walks_[i].way;
      keep(i);
    }
  }

  /// A long path may have crossed one part of the surface and ended at one behind it: if the line to the foot has been
  /// on the other side, the search restarts between there and the point.
  void look_between() {
    std::vector<std::uint32_t> far;
    std::vector<Vec3> at;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      if (ways_[i] != Way::arrived || !(norm(feet_[i] - x_[i]) > kFarOff * scale_)) continue;
      far.push_back(static_cast<std::uint32_t>(i));
      for (int k = 1; k < kLooks; ++k) at.push_back(x_[i] + (feet_[i] - x_[i]) * (static_cast<double>(k) / kLooks));
    }
    if (far.empty()) return;
    evaluate(at);
    for (std::size_t j = 0; j < far.size(); ++j) {
      const std::uint32_t i = far[j];
      for (std::size_t k = 0; k + 1 < kLooks; ++k) {
        const std::size_t look = j * (kLooks - 1) + k;
        if (!(values_[look] * sign_[i] < 0) || !inside_[look]) continue;
        start(i, at[look]);
        Walk& w = walks_[i];
        const Vec3& same = k > 0 ? at[look - 1] : x_[i];
        (sign_[i] < 0 ? w.inner : w.outer) = same;
        (sign_[i] < 0 ? w.has_inner : w.has_outer) = true;
        break;
      }
    }
    const std::vector<std::uint32_t> again = open_;
    walk();
    for (const std::uint32_t i : again)
      if (walks_[i].way == Way::arrived && norm(walks_[i].foot - x_[i]) < norm(feet_[i] - x_[i])) keep(i);
  }

  /// The tangential component of the line from a foot to its point.
  Vec3 aside(std::uint32_t i, const Vec3& foot, const Vec3& normal) const {
    const Vec3 line = x_[i] - foot;
    return line - normal * dot(line, normal);
  }

  /// Moves along the zero set until the line to the point is normal to it.
  void settle() {
    std::vector<double> share(x_.size(), 1);
    std::vector<std::uint32_t> moving;
    for (std::size_t i = 0; i < x_.size(); ++i)
      if (ways_[i] == Way::arrived) moving.push_back(static_cast<std::uint32_t>(i));
    for (int count = 0; count < kFootSteps && !moving.empty(); ++count) {
      for (const std::uint32_t i : moving) {
        const Vec3 move = aside(i, feet_[i], normals_[i]);
        if (norm(move) > std::max(kSettled * norm(x_[i] - feet_[i]), 0.1 * noise_))
          start(i, feet_[i] + move * share[i]);
      }
      moving = open_;
      walk();
      for (const std::uint32_t i : moving) {
        const Walk& w = walks_[i];
        if (w.way != Way::arrived) {
          share[i] *= 0.25;
          continue;
        }
        // The remaining deviation determines the right step length, which depends on the curvature: a full step
        // overshoots outside convex regions and undershoots inside.
        const Vec3 before = aside(i, feet_[i], normals_[i]), after = aside(i, w.foot, w.normal);
        const double left = dot(before, after) / squared_norm(before);
        share[i] *= std::clamp(1 / std::max(0.1, 1 - left), 0.1, 4.0);
        if (norm(x_[i] - w.foot) < norm(x_[i] - feet_[i])) keep(i);
      }
    }
  }

  const ScalarField& field_;
  std::span<const Vec3> x_;
  Box3 box_;
  double scale_, exact_, noise_, longest_, reach_;
  std::vector<Walk> walks_;
  std::vector<double> sign_;
  std::vector<Vec3> feet_, normals_;
  std::vector<Way> ways_;
  std::vector<std::uint32_t> open_;  ///< unfinished searches
  std::vector<double> values_;       ///< results of the last evaluation
  std::vector<Vec3> gradients_;
  std::vector<std::uint8_t> inside_;
};

}  // namespace

void FieldDistance::measure(std::span<const Vec3> x, double farthest, std::span<MeasuredPoint> found) const {
  Feet feet(field_, x, farthest);
  feet.find();
  for (std::size_t i = 0; i < x.size(); ++i) found[i] = feet.result(i, farthest);
}

}  // namespace sansmesh::inline v1
