#include "sansmesh/measure/smallest_box.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"

namespace sansmesh {
namespace {

using Frame = std::array<Vec3, 3>;

constexpr int kDirections = 512;  ///< in which the outermost points are looked for
constexpr int kRounds = 30;

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

/// The points that lie outermost in one of many directions.
std::vector<Vec3> outermost(const std::vector<Vec3f>& points) {
  const std::vector<Vec3> d = directions();
  std::vector<std::uint32_t> found(2 * d.size());
  parallel_for(0, d.size(), 8, [&](std::size_t k) {
    const Vec3f direction(d[k]);
    float low = INFINITY, high = -INFINITY;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const float h = dot(direction, points[i]);
      if (h < low) low = h, found[2 * k] = static_cast<std::uint32_t>(i);
      if (h > high) high = h, found[2 * k + 1] = static_cast<std::uint32_t>(i);
    }
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

double volume_of(const std::vector<Vec3>& points, const Frame& frame) {
  double volume = 1;
  for (const Vec3& axis : frame) {
    double low = INFINITY, high = -INFINITY;
    for (const Vec3& p : points) low = std::min(low, dot(axis, p)), high = std::max(high, dot(axis, p));
    volume *= high - low;
  }
  return volume;
}

/// Turns the frame about its axis `k` so that the rectangle around the shadow of the points is smallest; that has a
/// side along an edge of the shadow's hull.
Frame turned(const std::vector<Vec3>& points, const Frame& frame, std::size_t k) {
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
    if (const double area = (high - low) * (above - below); area < best) best = area, c = x, s = y;
  }
  Frame result = frame;
  result[(k + 1) % 3] = normalized(u * c + v * s);
  result[(k + 2) % 3] = cross(frame[k], result[(k + 1) % 3]);
  return result;
}

}  // namespace

OrientedBox smallest_box(const std::vector<Vec3f>& points) {
  std::vector<Vec3f> finite;
  for (const Vec3f& p : points)
    if (is_finite(p)) finite.push_back(p);
  if (finite.empty()) throw DataError("no points to put into a box");
  const Vec3f base = finite[0];
  for (Vec3f& p : finite) p -= base;
  const std::vector<Vec3> outer = outermost(finite);

  const double h = std::sqrt(0.5);
  const Frame starts[] = {{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}},
                          {Vec3{h, h, 0}, Vec3{-0.5, 0.5, h}, Vec3{0.5, -0.5, h}},
                          {Vec3{h, 0, h}, Vec3{0.5, h, -0.5}, Vec3{-0.5, h, 0.5}},
                          {Vec3{0, h, h}, Vec3{h, 0.5, -0.5}, Vec3{-h, 0.5, -0.5}}};
  Frame best = starts[0];
  double least = volume_of(outer, best);
  for (const Frame& start : starts) {
    Frame frame = start;
    double volume = volume_of(outer, frame);
    for (int round = 0; round < kRounds; ++round) {
      const double before = volume;
      for (std::size_t k = 0; k < 3; ++k) {
        const Frame candidate = turned(outer, frame, k);
        if (const double v = volume_of(outer, candidate); v < volume) frame = candidate, volume = v;
      }
      if (!(volume < before * (1 - 1e-9))) break;
    }
    if (volume < least * (1 - 1e-9)) least = volume, best = frame;
  }

  // Exactly around all points, which reach a little beyond the outermost ones of the directions tried.
  struct Side {
    double size, middle;
    Vec3 axis;
  };
  std::array<Side, 3> sides;
  for (std::size_t k = 0; k < 3; ++k) {
    double low = INFINITY, high = -INFINITY;
    for (const Vec3f& p : finite) {
      const double along = dot(best[k], Vec3(p));
      low = std::min(low, along), high = std::max(high, along);
    }
    Vec3 axis = best[k];
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

}  // namespace sansmesh
