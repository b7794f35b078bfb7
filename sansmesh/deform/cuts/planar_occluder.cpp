#include "sansmesh/deform/cuts/planar_occluder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "sansmesh/box.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

using PlanePoint = PlanarOccluder::Point;
using PlaneEdge = PlanarOccluder::Edge;
constexpr double kEndless = std::numeric_limits<double>::infinity();

PlanePoint minus(const PlanePoint& p, const PlanePoint& q) { return {p.a - q.a, p.b - q.b}; }
double cross2(const PlanePoint& p, const PlanePoint& q) { return p.a * q.b - p.b * q.a; }
double dot2(const PlanePoint& p, const PlanePoint& q) { return p.a * q.a + p.b * q.b; }
bool is_line(const PlaneEdge& e) { return e.length == kEndless; }
PlanePoint at(const PlaneEdge& e, double t) { return {e.begin.a + e.along.a * t, e.begin.b + e.along.b * t}; }
/// Parameters on an edge are clamped to it; lines are unbounded.
double on_edge(const PlaneEdge& e, double t) { return is_line(e) ? t : std::clamp(t, 0.0, e.length); }

/// ‖h − p‖ + ‖p − x‖ − ‖h − x‖ without cancellation for nearly collinear points: (a + b)² − c² = 2 (ab + u·v), and ab +
/// u·v = ‖u × v‖² / (ab − u·v).
Detour detour_over(const Vec3& p, const Vec3& h, const Vec3& x) {
  const Vec3 u = h - p, v = x - p, straight = x - h;
  const double a = norm(u), b = norm(v), c = norm(straight), along = dot(u, v);
  const double sum = along < 0 ? squared_norm(cross(u, v)) / (a * b - along) : a * b + along;
  Detour result;
  result.extra = a + b + c > 0 ? 2 * sum / (a + b + c) : 0;
  if (b > 0 && c > 0) result.gradient = v / b - straight / c;
  return result;
}

/// Best bend on an edge for a path between two points, given their positions along it and distances from its line.
double bend_at(const PlaneEdge& e, double t0, double r0, double t1, double r1) {
  const double sum = r0 + r1;
  return on_edge(e, sum > 0 ? t0 + (t1 - t0) * (r0 / sum) : t0);
}

bool loop_holds(const std::vector<PlaneEdge>& border, const PlanePoint& p) {
  bool inside = false;
  for (const PlaneEdge& e : border) {
    const PlanePoint end = at(e, e.length);
    if ((e.begin.b > p.b) == (end.b > p.b)) continue;
    const double side = cross2(minus(end, e.begin), minus(p, e.begin));
    if ((side > 0) == (end.b > e.begin.b)) inside = !inside;
  }
  return inside;
}

double loop_distance(const std::vector<PlaneEdge>& border, const PlanePoint& p) {
  double least = kEndless;
  for (const PlaneEdge& e : border) {
    const PlanePoint off = minus(p, at(e, on_edge(e, dot2(minus(p, e.begin), e.along))));
    least = std::min(least, dot2(off, off));
  }
  return std::sqrt(least);
}

void fail(const std::string& what) { throw ArgumentError(what); }

/// Whether two edges have a common point other than the corner between them.
bool edges_cross(const PlaneEdge& e, const PlaneEdge& f, bool neighbours) {
  if (neighbours) return false;
  const PlanePoint e1 = at(e, e.length), f1 = at(f, f.length);
  const double a = cross2(e.along, minus(f.begin, e.begin)), b = cross2(e.along, minus(f1, e.begin));
  const double c = cross2(f.along, minus(e.begin, f.begin)), d = cross2(f.along, minus(e1, f.begin));
  return (a > 0) != (b > 0) && (c > 0) != (d > 0);
}

}  // namespace

bool PlanarOccluder::covers(const Point& p) const {
  if (is_line(borders_[0][0])) return cross2(borders_[0][0].along, minus(p, borders_[0][0].begin)) > 0;
  bool inside = false;
  for (const std::vector<Edge>& border : borders_) inside = inside != loop_holds(border, p);
  return inside;
}

double PlanarOccluder::depth(const Point& p, Point* inwards) const {
  double least = kEndless;
  Point away;
  for (const std::vector<Edge>& border : borders_)
    for (const Edge& e : border) {
      const Point from = minus(p, e.begin);
      const Point off = minus(p, at(e, on_edge(e, dot2(from, e.along))));
      const double d = dot2(off, off);
      if (d < least) least = d, away = off;
    }
  const double distance = std::sqrt(least);
  const double sign = covers(p) ? 1 : -1;
  if (inwards) *inwards = distance > 0 ? Point{sign * away.a / distance, sign * away.b / distance} : Point{};
  return sign * distance;
}

void PlanarOccluder::detours(const Vec3& handle, std::span<const Vec3> x, std::span<Detour> found) const {
  const double s0 = height(handle);
  const Point p0 = in_plane(handle);
  for (std::size_t i = 0; i < x.size(); ++i) {
    found[i] = {};
    const double s1 = height(x[i]);
    if ((s0 >= 0) == (s1 >= 0)) continue;
    const Point p1 = in_plane(x[i]);
    const double share = std::abs(s0) / (std::abs(s0) + std::abs(s1));
    if (!covers({p0.a + (p1.a - p0.a) * share, p0.b + (p1.b - p0.b) * share})) continue;
    double least = kEndless;
    Point best;
    for (const std::vector<Edge>& border : borders_)
      for (const Edge& e : border) {
        const Point from0 = minus(p0, e.begin), from1 = minus(p1, e.begin);
        const double t0 = dot2(from0, e.along), t1 = dot2(from1, e.along);
        const double r0 = std::hypot(cross2(e.along, from0), s0), r1 = std::hypot(cross2(e.along, from1), s1);
        const double t = bend_at(e, t0, r0, t1, r1);
        const double way = std::hypot(t - t0, r0) + std::hypot(t - t1, r1);
        if (way < least) least = way, best = at(e, t);
      }
    found[i] = detour_over(in_space(best), handle, x[i]);
  }
}

void PlanarOccluder::gaps(std::span<const Vec3> x, std::span<const Vec3> sources,
                          std::span<const std::array<Vec3, 3>> jacobians, std::span<Gap> found) const {
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3& u = sources[i];
    const double s = height(x[i]), z = height(u), a = std::abs(s), b = std::abs(z), sum = a + b;
    const double side = s >= 0 ? 1 : -1, side_u = z >= 0 ? 1 : -1;
    const double across = side == side_u ? -1 : 1;  // above 0: on different sides
    const double share = sum > 0 ? a / sum : 0;     // crossing on the segment from x to u
    const Vec3 way = u - x[i];
    Point inwards;
    const double within = depth(in_plane(x[i] + way * share), &inwards);
    const double apart = across * a * (1 - share);
    Gap& gap = found[i];
    gap = {std::min(apart, within), {}};
    if (jacobians.empty()) continue;
    const Vec3 inside = a_ * inwards.a + b_ * inwards.b;
    for (std::size_t k = 0; k < 3; ++k) {
      const double da = side * normal_[k], db = side_u * dot(normal_, jacobians[i][k]);
      if (apart <= within) {
        gap.gradient[k] = across * ((1 - share) * (1 - share) * da + share * share * db);
        continue;
      }
      const double dshare = sum > 0 ? ((1 - share) * da - share * db) / sum : 0;
      Vec3 moved = jacobians[i][k] * share + way * dshare;
      moved[k] += 1 - share;
      gap.gradient[k] = dot(inside, moved);
    }
  }
}

void PlanarOccluder::crossings(const Vec3& a, const Vec3& b, std::vector<double>& found) const {
  const double s0 = height(a), s1 = height(b);
  if ((s0 >= 0) == (s1 >= 0)) return;
  const double share = std::abs(s0) / (std::abs(s0) + std::abs(s1));
  if (covers(in_plane(a + (b - a) * share))) found.push_back(share);
}

void PlanarOccluder::border_points(const Vec3& a, const Vec3& b, const Vec3& c, std::vector<Vec3>& found) const {
  // The triangle cuts the plane in a segment, which the border's edges intersect.
  const std::array<Vec3, 3> corners = {a, b, c};
  std::array<Point, 2> ends;
  std::size_t n = 0;
  for (std::size_t k = 0; k < 3 && n < 2; ++k) {
    const Vec3 &p = corners[k], &q = corners[(k + 1) % 3];
    const double s0 = height(p), s1 = height(q);
    if ((s0 >= 0) != (s1 >= 0)) ends[n++] = in_plane(p + (q - p) * (std::abs(s0) / (std::abs(s0) + std::abs(s1))));
  }
  if (n < 2) return;
  const Point way = minus(ends[1], ends[0]);
  for (const std::vector<Edge>& border : borders_)
    for (const Edge& e : border) {
      const double f0 = cross2(e.along, minus(ends[0], e.begin)), f1 = cross2(e.along, minus(ends[1], e.begin));
      if ((f0 > 0) == (f1 > 0)) continue;
      if (!is_line(e)) {  // the corners are on different sides of the segment
        const double g0 = cross2(way, minus(e.begin, ends[0])), g1 = cross2(way, minus(at(e, e.length), ends[0]));
        if ((g0 > 0) == (g1 > 0)) continue;
      }
      const double t = f0 / (f0 - f1);
      found.push_back(in_space({ends[0].a + way.a * t, ends[0].b + way.b * t}));
    }
}

std::shared_ptr<const PlanarOccluder> half_plane(const Vec3& edge_point, const Vec3& normal, const Vec3& into) {
  if (!is_finite(edge_point) || !is_finite(normal) || !is_finite(into))
    fail("a half-plane has a number that is not finite");
  const std::shared_ptr<PlanarOccluder> made(new PlanarOccluder);
  made->origin_ = edge_point;
  made->normal_ = normalized(normal);
  if (made->normal_ == Vec3{}) fail("a half-plane has a normal of length 0");
  const Vec3 flat = into - made->normal_ * dot(into, made->normal_);
  if (!(norm(flat) > 1e-9 * norm(into)))
    fail("the direction of a half-plane must be in its plane, neither along the normal nor zero");
  made->b_ = normalized(flat);
  made->a_ = cross(made->b_, made->normal_);
  made->borders_ = {{PlaneEdge{{0, 0}, {1, 0}, kEndless}}};
  return made;
}

std::shared_ptr<const PlanarOccluder> polygon_occluder(const std::vector<std::vector<Vec3>>& loops) {
  if (loops.empty()) fail("a polygon has no corners");
  const auto name = [](std::size_t l) { return l == 0 ? std::string("a polygon") : "hole " + std::to_string(l); };
  for (std::size_t l = 0; l < loops.size(); ++l)
    if (loops[l].size() < 3)
      fail(name(l) + " has " + std::to_string(loops[l].size()) + " corners: at least three are needed");
  Box3 box;
  for (const std::vector<Vec3>& loop : loops)
    for (const Vec3& p : loop) {
      if (!is_finite(p)) fail("a polygon has a corner that is not finite");
      box.extend(p);
    }
  const double size = box.diagonal();
  const std::shared_ptr<PlanarOccluder> made(new PlanarOccluder);
  Vec3 area;
  for (std::size_t i = 0; i < loops[0].size(); ++i)
    area += cross(loops[0][i] - loops[0][0], loops[0][(i + 1) % loops[0].size()] - loops[0][0]);
  if (!(norm(area) > 1e-12 * size * size)) fail("a polygon has no area: its corners lie on a line");
  made->origin_ = loops[0][0];
  made->normal_ = normalized(area);
  tangent_frame(made->normal_, made->a_, made->b_);
  for (std::size_t l = 0; l < loops.size(); ++l) {
    std::vector<PlaneEdge> border;
    double turn = 0;
    for (std::size_t i = 0; i < loops[l].size(); ++i) {
      const Vec3 &p = loops[l][i], &q = loops[l][(i + 1) % loops[l].size()];
      if (std::abs(made->height(p)) > 1e-6 * size)
        fail("corner " + std::to_string(i + 1) + " of " + name(l) + " lies off the plane of the others");
      const PlanePoint begin = made->in_plane(p), way = minus(made->in_plane(q), begin);
      turn += cross2(begin, made->in_plane(q));
      const double length = std::hypot(way.a, way.b);
      if (length > 0) border.push_back({begin, {way.a / length, way.b / length}, length});
    }
    if (border.size() < 3) fail(name(l) + " has fewer than three different corners");
    if ((turn > 0) != (l == 0)) {  // outlines run counter-clockwise, holes clockwise
      std::reverse(border.begin(), border.end());
      for (PlaneEdge& e : border) e = {at(e, e.length), {-e.along.a, -e.along.b}, e.length};
    }
    made->borders_.push_back(std::move(border));
  }
  std::vector<PlaneEdge> all;
  std::vector<std::array<std::size_t, 3>> of;  // loop, index in it, size of it
  for (std::size_t l = 0; l < made->borders_.size(); ++l)
    for (std::size_t i = 0; i < made->borders_[l].size(); ++i)
      all.push_back(made->borders_[l][i]), of.push_back({l, i, made->borders_[l].size()});
  for (std::size_t i = 0; i < all.size(); ++i)
    for (std::size_t j = i + 1; j < all.size(); ++j) {
      const bool neighbours = of[i][0] == of[j][0] && (of[j][1] - of[i][1] == 1 || of[j][1] - of[i][1] == of[i][2] - 1);
      if (edges_cross(all[i], all[j], neighbours)) fail("edges of a polygon cross each other");
    }
  // No edges cross, so one corner decides for its loop.
  for (std::size_t l = 1; l < made->borders_.size(); ++l)
    for (std::size_t m = 0; m < made->borders_.size(); ++m) {
      if (m == l) continue;
      const auto touches = [&](const std::vector<PlaneEdge>& one, const std::vector<PlaneEdge>& other) {
        return std::any_of(one.begin(), one.end(),
                           [&](const PlaneEdge& e) { return loop_distance(other, e.begin) <= 1e-9 * size; });
      };
      if (touches(made->borders_[l], made->borders_[m]) || touches(made->borders_[m], made->borders_[l]))
        fail("hole " + std::to_string(l) + " of a polygon touches " +
             (m == 0 ? "its outline" : "hole " + std::to_string(m)));
      if (loop_holds(made->borders_[m], made->borders_[l][0].begin) == (m == 0)) continue;
      fail(m == 0 ? "hole " + std::to_string(l) + " of a polygon does not lie within its outline"
                  : "hole " + std::to_string(l) + " of a polygon lies within hole " + std::to_string(m));
    }
  return made;
}

}  // namespace sansmesh::inline v1
