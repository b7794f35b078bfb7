#include "sansmesh/mesh/booleans/triangle_cutter.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "sansmesh/core/morton.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::uint32_t turned(std::uint32_t i) { return i == 2 ? 0 : i + 1; }
constexpr std::uint32_t turned_twice(std::uint32_t i) { return i == 0 ? 2 : i - 1; }

/// Relative value of the in-circle determinant from which a flip is an improvement.
constexpr double kClearlyInside = 1e-10;

}  // namespace

TriangleCutter::TriangleCutter(const ExactSpace& space, const Triangle& corners, std::vector<ExactPoint> points)
    : space_(space),
      corners_(corners),
      axis_(space.main_axis(corners[0], corners[1], corners[2])),
      orientation_(space.turn(corners[0], corners[1], corners[2], axis_)),
      points_(std::move(points)) {
  const Vec3 o = space.position(corners[0]), a = space.position(corners[1]) - o, b = space.position(corners[2]) - o;
  frame_[0] = normalized(squared_norm(a) > squared_norm(b) ? a : b);
  frame_[1] = cross(normalized(cross(a, b)), frame_[0]);
  for (const ExactPoint& p : points_) {
    const Vec3 d = p.approximate() - o;
    flat_.push_back({dot(d, frame_[0]), dot(d, frame_[1])});
  }
  faces_.push_back({{0, 1, 2}});
  face_of_.assign(points_.size(), 0);
  // Neighbours in sequence keep the search for the face of each point short.
  std::vector<std::uint32_t> order(points_.size() - 3);
  std::iota(order.begin(), order.end(), 3u);
  if (order.size() > 16) {
    std::array<double, 2> lower = flat_[0], upper = flat_[0];
    for (const auto& f : flat_)
      for (std::size_t k = 0; k < 2; ++k) lower[k] = std::min(lower[k], f[k]), upper[k] = std::max(upper[k], f[k]);
    const double extent = std::max(upper[0] - lower[0], upper[1] - lower[1]);
    const double scale = extent > 0 ? 65535 / extent : 0;
    std::vector<std::uint64_t> key(points_.size());
    for (std::size_t i = 3; i < points_.size(); ++i)
      key[i] = morton_code(static_cast<std::uint32_t>((flat_[i][0] - lower[0]) * scale),
                           static_cast<std::uint32_t>((flat_[i][1] - lower[1]) * scale), 0);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t i, std::uint32_t j) { return key[i] != key[j] ? key[i] < key[j] : i < j; });
  }
  for (const std::uint32_t p : order) insert(p);
}

int TriangleCutter::turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
  return orientation_ * space_.turn(points_[a], points_[b], points_[c], axis_);
}

TriangleCutter::Side TriangleCutter::across(Side side) const {
  const std::uint32_t next = faces_[side.face].next[side.edge];
  if (next == kNone) return {};
  const std::uint32_t from = faces_[side.face].vertex[turned(side.edge)];
  const Face& f = faces_[next];
  for (std::uint32_t e = 0; e < 3; ++e)
    if (f.vertex[e] == from) return {next, e};
  return {};
}

void TriangleCutter::link(Side a, Side b) {
  if (a.face != kNone) faces_[a.face].next[a.edge] = b.face;
  if (b.face != kNone) faces_[b.face].next[b.edge] = a.face;
}

/// Gives an edge of a new face the neighbour and segment of an edge of a former one.
void TriangleCutter::relink(Side inner, Side outer, std::uint32_t segment) {
  link(inner, outer);
  faces_[inner.face].segment[inner.edge] = segment;
}

TriangleCutter::Side TriangleCutter::locate(std::uint32_t p, bool& on_edge) {
  std::uint32_t face = last_;
  while (true) {
    random_ = random_ * 1664525u + 1013904223u;  // walks with a fixed order of edges can run in circles
    const std::uint32_t first = (random_ >> 16) % 3;
    std::uint32_t zero = 3;
    bool moved = false;
    for (std::uint32_t i = 0; i < 3 && !moved; ++i) {
      const std::uint32_t e = (first + i) % 3;
      const Face& f = faces_[face];
      const int side = turn(f.vertex[e], f.vertex[turned(e)], p);
      if (side == 0) zero = e;
      if (side < 0 && f.next[e] != kNone) face = f.next[e], moved = true;
    }
    if (moved) continue;
    last_ = face;
    on_edge = zero < 3;
    return {face, on_edge ? zero : 0};
  }
}

void TriangleCutter::insert(std::uint32_t p) {
  bool on_edge = false;
  const Side at = locate(p, on_edge);
  if (on_edge) {
    split_edge(at, p);
  } else {
    split_face(at.face, p);
  }
  legalize();
}

void TriangleCutter::split_face(std::uint32_t face, std::uint32_t p) {
  const Face old = faces_[face];
  const std::array<Side, 3> outer{across({face, 0}), across({face, 1}), across({face, 2})};
  const auto n = static_cast<std::uint32_t>(faces_.size());
  const std::array<std::uint32_t, 3> faces{face, n, n + 1};
  faces_.resize(faces_.size() + 2);
  for (std::uint32_t e = 0; e < 3; ++e) faces_[faces[e]] = Face{{old.vertex[e], old.vertex[turned(e)], p}};
  for (std::uint32_t e = 0; e < 3; ++e) {
    relink({faces[e], 0}, outer[e], old.segment[e]);
    link({faces[e], 1}, {faces[turned(e)], 2});
    face_of_[old.vertex[e]] = faces[e];
    pending_.push_back({faces[e], 0});
  }
  face_of_[p] = face;
}

void TriangleCutter::split_edge(Side side, std::uint32_t p) {
  const Side other = across(side);
  // Each of both faces (a, b, c) with p on a b becomes (a, p, c) and (p, b, c).
  std::array<std::array<std::uint32_t, 2>, 2> halves{};
  const std::uint32_t segment = faces_[side.face].segment[side.edge];
  std::size_t count = 0;
  for (const Side s : {side, other}) {
    if (s.face == kNone) continue;
    const Face old = faces_[s.face];
    const std::uint32_t a = old.vertex[s.edge], b = old.vertex[turned(s.edge)], c = old.vertex[turned_twice(s.edge)];
    const Side to_bc = across({s.face, turned(s.edge)}), to_ca = across({s.face, turned_twice(s.edge)});
    const auto added = static_cast<std::uint32_t>(faces_.size());
    faces_.push_back(Face{{p, b, c}});
    faces_[s.face] = Face{{a, p, c}};
    relink({added, 1}, to_bc, old.segment[turned(s.edge)]);
    relink({s.face, 2}, to_ca, old.segment[turned_twice(s.edge)]);
    link({s.face, 1}, {added, 2});
    faces_[s.face].segment[0] = faces_[added].segment[0] = segment;
    face_of_[a] = face_of_[c] = face_of_[p] = s.face;
    face_of_[b] = added;
    pending_.push_back({added, 1});
    pending_.push_back({s.face, 2});
    halves[count++] = {s.face, added};
  }
  if (count < 2) return;
  link({halves[0][0], 0}, {halves[1][1], 0});
  link({halves[0][1], 0}, {halves[1][0], 0});
}

/// Exchanges the diagonal of the two faces at an edge, unless they are not strictly convex together.
bool TriangleCutter::flip(Side side) {
  const Side other = across(side);
  const Face f = faces_[side.face], g = faces_[other.face];
  const std::uint32_t a = f.vertex[side.edge], b = f.vertex[turned(side.edge)], c = f.vertex[turned_twice(side.edge)],
                      d = g.vertex[turned_twice(other.edge)];
  if (turn(a, d, c) <= 0 || turn(d, b, c) <= 0) return false;
  const Side bc = across({side.face, turned(side.edge)}), ca = across({side.face, turned_twice(side.edge)}),
             ad = across({other.face, turned(other.edge)}), db = across({other.face, turned_twice(other.edge)});
  faces_[side.face] = Face{{a, d, c}};
  faces_[other.face] = Face{{d, b, c}};
  relink({side.face, 0}, ad, g.segment[turned(other.edge)]);
  relink({side.face, 2}, ca, f.segment[turned_twice(side.edge)]);
  relink({other.face, 0}, db, g.segment[turned_twice(other.edge)]);
  relink({other.face, 1}, bc, f.segment[turned(side.edge)]);
  link({side.face, 1}, {other.face, 2});
  face_of_[a] = face_of_[c] = face_of_[d] = side.face;
  face_of_[b] = other.face;
  return true;
}

/// Whether the circle of a face contains the opposite vertex of its neighbour.
bool TriangleCutter::improves(Side side) const {
  const Side other = across(side);
  const Face &f = faces_[side.face], &g = faces_[other.face];
  const auto& d = flat_[g.vertex[turned_twice(other.edge)]];
  std::array<std::array<double, 3>, 3> m{};
  double scale = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& p = flat_[f.vertex[i]];
    const double x = p[0] - d[0], y = p[1] - d[1];
    m[i] = {x, y, x * x + y * y};
    scale = std::max(scale, m[i][2]);
  }
  const double det = m[0][2] * (m[1][0] * m[2][1] - m[2][0] * m[1][1]) -
                     m[1][2] * (m[0][0] * m[2][1] - m[2][0] * m[0][1]) +
                     m[2][2] * (m[0][0] * m[1][1] - m[1][0] * m[0][1]);
  return det > kClearlyInside * scale * scale;
}

void TriangleCutter::legalize() {
  // Flips of nearly cocircular points could alternate: their number is limited.
  std::size_t left = 64 + 8 * faces_.size();
  while (!pending_.empty()) {
    const Side side = pending_.back();
    pending_.pop_back();
    const Face& f = faces_[side.face];
    if (left == 0 || f.next[side.edge] == kNone || f.segment[side.edge] != kNone) continue;
    if (!improves(side)) continue;
    const Side other = across(side);
    if (!flip(side)) continue;
    --left;
    for (const Side s : {Side{side.face, 0}, Side{side.face, 2}, Side{other.face, 0}, Side{other.face, 1}})
      pending_.push_back(s);
  }
}

/// The edge of the next face that begins at the vertex at which `side` begins.
TriangleCutter::Side TriangleCutter::around(Side side, bool clockwise) const {
  if (clockwise) {
    const Side other = across(side);
    return other.face == kNone ? Side{} : Side{other.face, turned(other.edge)};
  }
  return across({side.face, turned_twice(side.edge)});
}

/// Calls visit(side) for the edges that begin at a vertex, one of each face, until it returns true.
template <class Visit>
void TriangleCutter::visit_around(std::uint32_t vertex, const Visit& visit) const {
  const Face& f = faces_[face_of_[vertex]];
  const std::uint32_t e = f.vertex[0] == vertex ? 0 : f.vertex[1] == vertex ? 1 : 2;
  const Side first{face_of_[vertex], e};
  Side side = first;
  do {
    if (visit(side)) return;
    side = around(side, false);
  } while (side.face != kNone && side.face != first.face);
  if (side.face != kNone) return;
  for (side = around(first, true); side.face != kNone; side = around(side, true))
    if (visit(side)) return;
}

/// The edge from a to b as an edge of the face on its left, or of the face on its right; without a face: no edge.
TriangleCutter::Side TriangleCutter::edge_between(std::uint32_t a, std::uint32_t b) const {
  Side found;
  visit_around(a, [&](Side side) {
    const Face& f = faces_[side.face];
    if (f.vertex[turned(side.edge)] == b) return found = side, true;
    if (f.vertex[turned_twice(side.edge)] == b) return found = {side.face, turned_twice(side.edge)}, true;
    return false;
  });
  return found;
}

void TriangleCutter::mark(std::uint32_t a, std::uint32_t b, std::uint32_t segment) {
  const Side side = edge_between(a, b);
  if (faces_[side.face].segment[side.edge] != kNone) return;  // the first one remains
  faces_[side.face].segment[side.edge] = segment;
  const Side other = across(side);
  if (other.face != kNone) faces_[other.face].segment[other.edge] = segment;
}

void TriangleCutter::add(const CutterSegment& segment) {
  segments_.push_back(segment);
  const auto index = static_cast<std::uint32_t>(segments_.size() - 1);
  for (std::uint32_t a = segment.from; a != segment.to;) a = step(a, segment.to, index);
}

/// Makes the first part of the segment from a to b an edge; returns the end of this part.
std::uint32_t TriangleCutter::step(std::uint32_t a, std::uint32_t b, std::uint32_t segment) {
  std::uint32_t reached = kNone;
  Side crossed;  // the first edge that the segment crosses
  visit_around(a, [&](Side side) {
    const Face& f = faces_[side.face];
    const std::uint32_t r = f.vertex[turned(side.edge)], s = f.vertex[turned_twice(side.edge)];
    if (r == b || s == b) return reached = b, true;
    const int of_r = turn(a, r, b), of_s = turn(a, b, s);
    if (of_r == 0 && of_s > 0) return reached = r, true;
    if (of_s == 0 && of_r > 0) return reached = s, true;
    if (of_r > 0 && of_s > 0) return crossed = {side.face, turned(side.edge)}, true;
    return false;
  });
  std::vector<std::array<std::uint32_t, 2>> edges;
  while (reached == kNone) {
    const Face& f = faces_[crossed.face];
    const std::uint32_t right = f.vertex[crossed.edge], left = f.vertex[turned(crossed.edge)];
    if (const std::uint32_t other = f.segment[crossed.edge]; other != kNone) {
      const auto p = static_cast<std::uint32_t>(points_.size());
      points_.push_back(space_.meeting({corners_}, segments_[other].plane, segments_[segment].plane));
      const Vec3 d = points_.back().approximate() - space_.position(corners_[0]);
      flat_.push_back({dot(d, frame_[0]), dot(d, frame_[1])});
      face_of_.push_back(0);
      split_edge(crossed, p);
      reached = p;
      break;
    }
    edges.push_back({right, left});
    const Side other = across(crossed);
    const std::uint32_t v = faces_[other.face].vertex[turned_twice(other.edge)];
    const int side = v == b ? 0 : turn(a, b, v);
    if (side == 0) reached = v;
    // Seen from the far face, the edge runs from left to right.
    crossed = {other.face, side > 0 ? turned(other.edge) : turned_twice(other.edge)};
  }
  if (!edges.empty()) free_corridor(a, reached, std::move(edges));
  mark(a, reached, segment);
  legalize();
  return reached;
}

/// Flips the edges that cross a b until a b is an edge (sloan1993).
void TriangleCutter::free_corridor(std::uint32_t a, std::uint32_t b,
                                   std::vector<std::array<std::uint32_t, 2>> crossed) {
  for (std::size_t i = 0; i < crossed.size(); ++i) {
    const auto [from, to] = crossed[i];
    const Side side = edge_between(from, to);
    const Side other = across(side);
    const std::uint32_t c = faces_[side.face].vertex[turned_twice(side.edge)],
                        d = faces_[other.face].vertex[turned_twice(other.edge)];
    if (!flip(side)) {
      crossed.push_back({from, to});
      continue;
    }
    pending_.push_back({side.face, 1});
    const bool touches = c == a || c == b || d == a || d == b;
    if (!touches && turn(a, b, c) * turn(a, b, d) < 0) crossed.push_back({c, d});
  }
}

std::vector<TriangleCutter::Part> TriangleCutter::parts() const {
  std::vector<Part> parts;
  parts.reserve(faces_.size());
  for (const Face& f : faces_)
    parts.push_back({f.vertex, {f.segment[0] != kNone, f.segment[1] != kNone, f.segment[2] != kNone}});
  return parts;
}

}  // namespace sansmesh::inline v1
