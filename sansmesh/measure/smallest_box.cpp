#include "sansmesh/measure/smallest_box.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "sansmesh/box.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

using Frame = std::array<Vec3, 3>;

constexpr int kDirections = 512;  ///< directions for outermost points and for sides of the box
constexpr std::size_t kRun = 64;  ///< points per run
constexpr int kRounds = 30;
/// Up to so many points, all planes through three of them are tried as sides, too.
constexpr std::size_t kFew = 20;
/// Numbers of frames that are rotated, and of the best ones refined by small steps in all directions. Up to kSome
/// points all frames are used.
constexpr std::size_t kCandidates = 16, kStepped = 3, kSome = 100;
/// First and last of these steps (radians).
constexpr double kFirstStep = 0.2, kLastStep = 1e-3;
/// Padding of flat boxes for comparison, relative to the diagonal: among boxes without volume the smallest area wins.
constexpr double kPadding = 1e-9;
/// Relative difference below which volumes are equal.
constexpr double kSameVolume = 1e-9;
/// Rounds that add points outside a box to those that it was computed for.
constexpr int kGrown = 8;

/// Evenly spread over a half sphere: a spiral with the golden angle.
std::vector<Vec3> directions() {
  std::vector<Vec3> result;
  for (int i = 0; i < kDirections; ++i) {
    const double z = (i + 0.5) / kDirections, r = std::sqrt(1 - z * z),
                 angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
    result.push_back({r * std::cos(angle), r * std::sin(angle), z});
  }
  return result;
}

/// Points that are outermost in one of many directions; among equally far ones the first. Runs of points, which are
/// mostly compact, are skipped if the box around them is not far out.
std::vector<Vec3> outermost(const std::vector<Vec3f>& points) {
  const std::vector<Vec3> d = directions();
  std::vector<Box3f> boxes((points.size() + kRun - 1) / kRun);
  float size = 0;
  for (std::size_t i = 0; i < points.size(); ++i) boxes[i / kRun].extend(points[i]);
  for (const Box3f& box : boxes)
    for (int k = 0; k < 3; ++k) size = std::max({size, std::abs(box.lower[k]), std::abs(box.upper[k])});
  const float rounding = 2e-6f * size;
  std::vector<std::uint32_t> found(2 * d.size());
  parallel_for(0, d.size(), 8, [&](std::size_t k) {
    const Vec3f direction(d[k]);
    float low = INFINITY, high = -INFINITY;
    std::size_t lowest = 0, highest = 0;
    const auto look = [&](std::size_t i) {
      const float h = dot(direction, points[i]);
      if (h < low || (h == low && i < lowest)) low = h, lowest = i;
      if (h > high || (h == high && i < highest)) high = h, highest = i;
    };
    for (std::size_t i = 0; i < points.size(); i += kRun) look(i);
    for (std::size_t b = 0; b < boxes.size(); ++b) {
      const Vec3f middle = boxes[b].center(), half = boxes[b].size() * 0.5f;
      const float at = dot(direction, middle), reach = std::abs(direction.x) * half.x + std::abs(direction.y) * half.y +
                                                       std::abs(direction.z) * half.z + rounding;
      if (at - reach > low && at + reach < high) continue;
      for (std::size_t i = b * kRun; i < std::min((b + 1) * kRun, points.size()); ++i) look(i);
    }
    found[2 * k] = static_cast<std::uint32_t>(lowest), found[2 * k + 1] = static_cast<std::uint32_t>(highest);
  });
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  std::vector<Vec3> result;
  result.reserve(found.size());
  for (const std::uint32_t i : found) result.emplace_back(points[i]);
  return result;
}

struct Point2 {
  double x, y;
  friend bool operator<(const Point2& a, const Point2& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; }
};

double turn(const Point2& a, const Point2& b, const Point2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Counter-clockwise, without points on its edges (Andrew's monotone chain).
std::vector<Point2> convex_hull(std::vector<Point2> p) {
  std::sort(p.begin(), p.end());
  std::vector<Point2> hull(2 * p.size());
  std::size_t n = 0;
  for (int side = 0; side < 2; ++side) {
    const std::size_t begin = n;
    for (const Point2& q : p) {
      while (n >= begin + 2 && turn(hull[n - 2], hull[n - 1], q) <= 0) --n;
      hull[n++] = q;
    }
    --n;
    std::reverse(p.begin(), p.end());
  }
  hull.resize(n);
  return hull;
}

struct Span {
  double low = INFINITY, high = -INFINITY;
};

template <class Point>
Span span_along(const std::vector<Point>& points, const Vec3& axis) {
  Span s;
  for (const Point& p : points) {
    const double along = dot(axis, Vec3(p));
    s.low = std::min(s.low, along), s.high = std::max(s.high, along);
  }
  return s;
}

template <class Point>
double volume_of(const std::vector<Point>& points, const Frame& frame, double padding) {
  double volume = 1;
  for (const Vec3& axis : frame) {
    const Span s = span_along(points, axis);
    volume *= s.high - s.low + padding;
  }
  return volume;
}

/// Rotates the frame about its axis `k` to the smallest rectangle around the projected points; it has a side along an
/// edge of their convex hull.
Frame turned(const std::vector<Vec3>& points, const Frame& frame, std::size_t k, double padding) {
  const Vec3 u = frame[(k + 1) % 3], v = frame[(k + 2) % 3];
  std::vector<Point2> shadow;
  shadow.reserve(points.size());
  for (const Vec3& p : points) shadow.push_back({dot(u, p), dot(v, p)});
  const std::vector<Point2> hull = convex_hull(std::move(shadow));
  double best = INFINITY, c = 1, s = 0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Point2 &a = hull[i], &b = hull[(i + 1) % hull.size()];
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    if (!(length > 0)) continue;
    const double x = (b.x - a.x) / length, y = (b.y - a.y) / length;
    double low = INFINITY, high = -INFINITY, below = INFINITY, above = -INFINITY;
    for (const Point2& p : hull) {
      const double along = x * p.x + y * p.y, across = x * p.y - y * p.x;
      low = std::min(low, along), high = std::max(high, along);
      below = std::min(below, across), above = std::max(above, across);
    }
    if (const double area = (high - low + padding) * (above - below + padding); area < best) best = area, c = x, s = y;
  }
  Frame result = frame;
  result[(k + 1) % 3] = normalized(u * c + v * s);
  result[(k + 2) % 3] = cross(frame[k], result[(k + 1) % 3]);
  return result;
}

struct Candidate {
  Frame frame;
  double volume;
};

/// Rotates a frame about its axes as long as the box shrinks.
void settle_box(const std::vector<Vec3>& points, double padding, Candidate& c) {
  for (int round = 0; round < kRounds; ++round) {
    const double before = c.volume;
    for (std::size_t k = 0; k < 3; ++k) {
      const Frame frame = turned(points, c.frame, k, padding);
      if (const double v = volume_of(points, frame, padding); v < c.volume) c = {frame, v};
    }
    if (!(c.volume < before * (1 - kSameVolume))) break;
  }
}

Frame rotated(const Frame& frame, const Vec3& axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const auto turn = [&](const Vec3& p) { return p * c + cross(axis, p) * s + axis * (dot(axis, p) * (1 - c)); };
  const Vec3 u = normalized(turn(frame[0])), w = normalized(cross(u, turn(frame[1])));
  return {u, cross(w, u), w};
}

/// Searches for a smaller box nearby with decreasing steps: rotations about single axes have local minima.
void step_around(const std::vector<Vec3>& points, double padding, Candidate& c) {
  for (double step = kFirstStep; step > kLastStep; step *= 0.5) {
    const Candidate from = c;
    for (int way = 0; way < 14; ++way) {
      const double sign = way % 2 == 0 ? 1 : -1;
      const Vec3 along = way < 6 ? from.frame[static_cast<std::size_t>(way / 2)]
                                 : normalized(from.frame[0] + from.frame[1] * ((way / 2) % 2 == 0 ? 1.0 : -1.0) +
                                              from.frame[2] * ((way - 6) / 4 == 0 ? 1.0 : -1.0));
      Candidate near{rotated(from.frame, along, sign * step), 0};
      near.volume = volume_of(points, near.frame, padding);
      for (std::size_t k = 0; k < 3; ++k) {
        const Frame frame = turned(points, near.frame, k, padding);
        if (const double v = volume_of(points, frame, padding); v < near.volume) near = {frame, v};
      }
      if (near.volume < c.volume * (1 - kSameVolume)) c = near;
    }
    settle_box(points, padding, c);
  }
}

/// A frame with the given axis and any two orthogonal to it.
Frame frame_along(const Vec3& axis) {
  const Vec3 other = std::abs(axis.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 u = normalized(cross(axis, other));
  return {axis, u, cross(axis, u)};
}

/// Directions of sides to try.
std::vector<Vec3> side_directions(const std::vector<Vec3>& points) {
  std::vector<Vec3> all = directions();
  if (points.size() > kFew) return all;
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = i + 1; j < points.size(); ++j)
      for (std::size_t k = j + 1; k < points.size(); ++k) {
        const Vec3 normal = cross(points[j] - points[i], points[k] - points[i]);
        if (const double length = norm(normal); length > 0) all.push_back(normal / length);
      }
  return all;
}

void sort_by_volume(std::vector<Candidate>& candidates) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.volume < b.volume; });
}

/// Frames with small boxes around these points; the axis-aligned and the given ones are included if none is smaller.
std::vector<Candidate> small_boxes(const std::vector<Vec3>& points, std::span<const Frame> given, double padding) {
  const std::vector<Vec3> sides = side_directions(points);
  std::vector<Candidate> tried(sides.size());
  parallel_for(0, sides.size(), 4, [&](std::size_t i) {
    const Frame frame = turned(points, frame_along(sides[i]), 0, padding);
    tried[i] = {frame, volume_of(points, frame, padding)};
  });
  sort_by_volume(tried);
  tried.resize(std::min(tried.size(), kCandidates));
  std::vector<Candidate> all;
  for (const Frame& frame : given) all.push_back({frame, volume_of(points, frame, padding)});
  all.insert(all.end(), tried.begin(), tried.end());
  return all;
}

/// Adds the farthest points outside a box, on each side.
void add_beyond(const std::vector<Vec3f>& points, const Frame& frame, std::vector<Vec3>& some) {
  for (const Vec3& axis : frame) {
    const Span own = span_along(some, axis);
    Span all;
    std::size_t low = 0, high = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double along = dot(axis, Vec3(points[i]));
      if (along < all.low) all.low = along, low = i;
      if (along > all.high) all.high = along, high = i;
    }
    const double beyond = kSameVolume * (all.high - all.low);
    if (all.low < own.low - beyond) some.emplace_back(points[low]);
    if (all.high > own.high + beyond) some.emplace_back(points[high]);
  }
}

}  // namespace

OrientedBox smallest_box(const std::vector<Vec3f>& points, std::span<const std::array<Vec3, 3>> also) {
  std::vector<Vec3f> finite;
  for (const Vec3f& p : points)
    if (is_finite(p)) finite.push_back(p);
  if (finite.empty()) throw DataError("no points to put into a box");
  const Vec3f base = finite[0];
  Box3f extent;
  for (Vec3f& p : finite) p -= base, extent.extend(p);
  const double padding = kPadding * static_cast<double>(extent.diagonal());
  std::vector<Vec3> outer = outermost(finite);

  std::vector<Frame> given{{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}};
  given.insert(given.end(), also.begin(), also.end());
  // Boxes around the outermost points alone; points outside the best of them are added, and they are refined again.
  std::vector<Candidate> candidates = small_boxes(outer, given, padding);
  parallel_for(0, candidates.size(), 1, [&](std::size_t i) { settle_box(outer, padding, candidates[i]); });
  sort_by_volume(candidates);
  candidates.resize(std::min(candidates.size(), outer.size() <= kSome ? kCandidates : kStepped));
  parallel_for(0, candidates.size(), 1, [&](std::size_t i) { step_around(outer, padding, candidates[i]); });
  for (int round = 0; round < kGrown; ++round) {
    const std::size_t before = outer.size();
    for (const Candidate& c : candidates) add_beyond(finite, c.frame, outer);
    if (outer.size() == before) break;
    parallel_for(0, candidates.size(), 1, [&](std::size_t i) {
      candidates[i].volume = volume_of(outer, candidates[i].frame, padding);
      settle_box(outer, padding, candidates[i]);
    });
  }
  // The smallest of these and the given frames around all points; a given one, unless another is smaller.
  std::vector<Frame> frames = given;
  for (const Candidate& c : candidates) frames.push_back(c.frame);
  Frame best = given[0];
  double least = INFINITY;
  for (const Frame& frame : frames) {
    const double volume = volume_of(finite, frame, padding);
    if (volume < least * (1 - kSameVolume)) least = volume, best = frame;
  }

  // Exactly around all points, which exceed the outermost ones of the directions tried slightly.
  struct Side {
    double size, middle;
    Vec3 axis;
  };
  std::array<Side, 3> sides;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [low, high] = span_along(finite, best[k]);
    const Vec3 axis = best[k];
    double middle = 0.5 * (low + high);
    const double largest = std::max({std::abs(axis.x), std::abs(axis.y), std::abs(axis.z)});
    if (axis.x != -largest && axis.y != -largest && axis.z != -largest)
      sides[k] = {high - low, middle, axis};
    else
      sides[k] = {high - low, -middle, -axis};
  }
  std::stable_sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.size > b.size; });
  OrientedBox box;
  for (std::size_t k = 0; k < 3; ++k) {
    box.axes[k] = sides[k].axis;
    box.sizes[k] = sides[k].size;
    box.center += sides[k].axis * sides[k].middle;
  }
  if (dot(cross(box.axes[0], box.axes[1]), box.axes[2]) < 0) box.axes[2] = -box.axes[2];
  box.center += Vec3(base);
  return box;
}

namespace {

constexpr ReportRow kOrientedBoxRows[] = {
    reported<&OrientedBox::sizes>({.text = "Lengths of the sides", .unit = "length"}),
    reported<&OrientedBox::axes>({.text = "Directions of the sides"}),
    reported<&OrientedBox::center>({.text = "Middle", .unit = "length"})};

}  // namespace

const ReportSchema& OrientedBox::schema() {
  static constexpr ReportSchema schema{kOrientedBoxRows};
  return schema;
}

}  // namespace sansmesh::inline v1
