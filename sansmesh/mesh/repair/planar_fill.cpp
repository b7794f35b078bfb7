#include "sansmesh/mesh/repair/planar_fill.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>

namespace sansmesh::inline v1 {
namespace {

constexpr double kNearlyLongest =
    0.6;                            // relative to the longest squared edge; shorter edges stay, to avoid flat triangles
constexpr double kFlatTurn = 1e-9;  // relative to squared lengths: flatter corners count as straight
constexpr int kMostHalvings = 100;  // limit of rounds, against endless bisection by rounding

using Flat = std::array<double, 2>;
using Ring = std::vector<std::uint32_t>;

double turn(const Flat& a, const Flat& b, const Flat& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

double squared_length(const Flat& a, const Flat& b) {
  return (b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]);
}

double ring_area(const std::vector<Flat>& p, const Ring& ring) {
  double sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Flat &a = p[ring[i]], &b = p[ring[(i + 1) % ring.size()]];
    sum += a[0] * b[1] - a[1] * b[0];
  }
  return sum / 2;
}

bool in_ring(const std::vector<Flat>& p, const Ring& ring, const Flat& x) {
  bool within = false;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Flat &a = p[ring[i]], &b = p[ring[(i + 1) % ring.size()]];
    if ((a[1] > x[1]) != (b[1] > x[1]) && (turn(a, b, x) > 0) == (b[1] > a[1])) within = !within;
  }
  return within;
}

/// Joins a hole to the surrounding ring by a double edge from its rightmost point to a visible corner of the ring
/// (Eberly).
void join_hole(const std::vector<Flat>& p, Ring& ring, Ring hole) {
  std::rotate(hole.begin(),
              std::max_element(hole.begin(), hole.end(), [&](std::uint32_t a, std::uint32_t b) { return p[a] < p[b]; }),
              hole.end());
  const Flat& from = p[hole[0]];
  // First edge of the ring hit by a ray to the right.
  double least = std::numeric_limits<double>::infinity();
  std::size_t best = ring.size();
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Flat &a = p[ring[i]], &b = p[ring[(i + 1) % ring.size()]];
    if ((a[1] > from[1]) == (b[1] > from[1])) continue;
    const double x = a[0] + (b[0] - a[0]) * (from[1] - a[1]) / (b[1] - a[1]);
    if (x >= from[0] && x < least) least = x, best = a[0] > b[0] ? i : (i + 1) % ring.size();
  }
  if (best == ring.size()) return;
  // Its farther end; or, if corners are in between, the one of them at the smallest angle.
  const Flat meet{least, from[1]}, end = p[ring[best]];
  double flattest = std::numeric_limits<double>::infinity(), nearest = flattest;
  std::size_t seen = best;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Flat& x = p[ring[i]];
    if (x == end) continue;
    const double s = turn(from, meet, end) > 0 ? 1 : -1;
    if (s * turn(from, meet, x) < 0 || s * turn(meet, end, x) < 0 || s * turn(end, from, x) < 0) continue;
    const double slope = std::abs(x[1] - from[1]) / std::max(x[0] - from[0], 1e-300), d = squared_length(from, x);
    if (x[0] >= from[0] && (slope < flattest || (slope == flattest && d < nearest)))
      flattest = slope, nearest = d, seen = i;
  }
  // If the ring passes a corner several times, uses the pass with the hole on its inner side.
  for (std::size_t i = 0; i < ring.size(); ++i) {
    if (ring[i] != ring[seen]) continue;
    const Flat &a = p[ring[(i + ring.size() - 1) % ring.size()]], &b = p[ring[i]], &c = p[ring[(i + 1) % ring.size()]];
    const bool left_of_in = turn(a, b, from) > 0, left_of_out = turn(b, c, from) > 0;
    if (turn(a, b, c) >= 0 ? left_of_in && left_of_out : left_of_in || left_of_out) {
      seen = i;
      break;
    }
  }
  Ring joined(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(seen) + 1);
  joined.insert(joined.end(), hole.begin(), hole.end());
  joined.push_back(hole[0]);
  joined.insert(joined.end(), ring.begin() + static_cast<std::ptrdiff_t>(seen), ring.end());
  ring = std::move(joined);
}

void clip_ears(const std::vector<Flat>& p, Ring ring, std::vector<Triangle>& triangles) {
  const auto is_ear = [&](std::size_t i, double least) {
    const std::size_t n = ring.size();
    const std::uint32_t a = ring[(i + n - 1) % n], b = ring[i], c = ring[(i + 1) % n];
    const double doubled = turn(p[a], p[b], p[c]);
    if (!(doubled > least * (squared_length(p[a], p[b]) + squared_length(p[b], p[c])))) return false;
    for (std::size_t k = 0; k < n; ++k) {
      const Flat& x = p[ring[k]];
      if (x == p[a] || x == p[b] || x == p[c]) continue;
      if (turn(p[a], p[b], x) >= 0 && turn(p[b], p[c], x) >= 0 && turn(p[c], p[a], x) >= 0) return false;
    }
    return true;
  };
  std::size_t at = 0;
  while (ring.size() > 3) {
    const std::size_t n = ring.size();
    bool found = false;
    for (const double least : {1e-6, 0.0, -1e-9}) {
      for (std::size_t i = 0; i < n && !found; ++i)
        if (is_ear((at + i) % n, least)) at = (at + i) % n, found = true;
      if (found) break;
    }
    if (!found) at %= n;  // rounding: accepts the next corner
    triangles.push_back({ring[(at + n - 1) % n], ring[at], ring[(at + 1) % n]});
    ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(at));
    at = (at + 1) % ring.size();  // varies the corner, which gives fewer slivers
  }
  triangles.push_back({ring[0], ring[1], ring[2]});
}

using FlatEdge = std::pair<std::uint32_t, std::uint32_t>;

/// Maps the directed edges of triangles to the triangles.
std::map<FlatEdge, std::uint32_t> edges_of(const std::vector<Triangle>& triangles) {
  std::map<FlatEdge, std::uint32_t> of;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      of[{triangles[t][k], triangles[t][(k + 1) % 3]}] = static_cast<std::uint32_t>(t);
  return of;
}

/// Positive if d is inside the circumcircle of the counter-clockwise triangle (a, b, c).
double in_circle(const Flat& a, const Flat& b, const Flat& c, const Flat& d) {
  const double ax = a[0] - d[0], ay = a[1] - d[1], bx = b[0] - d[0], by = b[1] - d[1], cx = c[0] - d[0],
               cy = c[1] - d[1];
  const double aa = ax * ax + ay * ay, bb = bx * bx + by * by, cc = cx * cx + cy * cy;
  return ax * (by * cc - bb * cy) - ay * (bx * cc - bb * cx) + aa * (bx * cy - by * cx);
}

/// Flips inner edges until the triangulation is Delaunay.
void turn_edges(const std::vector<Flat>& p, std::vector<Triangle>& triangles) {
  std::map<FlatEdge, std::uint32_t> of = edges_of(triangles);
  std::vector<FlatEdge> open;
  for (const auto& [edge, t] : of)
    if (edge.first < edge.second) open.push_back(edge);
  std::size_t left = 64 * open.size() + 64;
  const auto third = [&](std::uint32_t t, const FlatEdge& e) {
    for (const std::uint32_t v : triangles[t])
      if (v != e.first && v != e.second) return v;
    return e.first;
  };
  while (!open.empty() && left-- > 0) {
    const FlatEdge e = open.back();
    open.pop_back();
    const auto one = of.find(e), two = of.find({e.second, e.first});
    if (one == of.end() || two == of.end()) continue;
    const std::uint32_t t = one->second, s = two->second;
    const auto [a, b] = e;
    const std::uint32_t c = third(t, e), d = third(s, e);
    if (c == d || of.count({c, d}) || of.count({d, c})) continue;
    const double scale = squared_length(p[a], p[b]) + squared_length(p[c], p[d]);
    const bool flat = !(turn(p[a], p[b], p[c]) > kFlatTurn * scale) || !(turn(p[b], p[a], p[d]) > kFlatTurn * scale);
    if (!flat && !(in_circle(p[a], p[b], p[c], p[d]) > 1e-12 * scale * scale)) continue;
    // (a, b, c) and (b, a, d) become (c, d, b) and (d, c, a).
    if (!(turn(p[c], p[d], p[b]) > kFlatTurn * scale) || !(turn(p[d], p[c], p[a]) > kFlatTurn * scale)) continue;
    of.erase(e), of.erase(FlatEdge{b, a});
    triangles[t] = {c, d, b}, triangles[s] = {d, c, a};
    for (const std::uint32_t k : {t, s})
      for (std::size_t i = 0; i < 3; ++i) of[{triangles[k][i], triangles[k][(i + 1) % 3]}] = k;
    for (const FlatEdge& f : {FlatEdge{d, b}, FlatEdge{b, c}, FlatEdge{c, a}, FlatEdge{a, d}})
      open.emplace_back(std::min(f.first, f.second), std::max(f.first, f.second));
  }
}

void halve_edge(std::vector<Flat>& p, std::vector<Triangle>& triangles, const FlatEdge& e, std::uint32_t t,
                std::uint32_t s) {
  const auto middle = static_cast<std::uint32_t>(p.size());
  p.push_back({0.5 * (p[e.first][0] + p[e.second][0]), 0.5 * (p[e.first][1] + p[e.second][1])});
  for (const std::uint32_t k : {t, s}) {
    Triangle half = triangles[k];
    for (std::uint32_t& v : half)
      if (v == e.first) v = middle;
    for (std::uint32_t& v : triangles[k])
      if (v == e.second) v = middle;
    triangles.push_back(half);
  }
}

/// Bisects inner edges between chosen points.
void keep_apart(std::vector<Flat>& p, std::vector<Triangle>& triangles, std::span<const std::uint8_t> chosen) {
  const auto is_chosen = [&](std::uint32_t v) { return v < chosen.size() && chosen[v]; };
  for (bool more = !chosen.empty(); more;) {
    more = false;
    const std::map<FlatEdge, std::uint32_t> of = edges_of(triangles);
    std::vector<std::uint8_t> used(triangles.size());
    for (const auto& [e, t] : of) {
      if (e.first > e.second || !is_chosen(e.first) || !is_chosen(e.second)) continue;
      const auto other = of.find({e.second, e.first});
      if (other == of.end()) continue;
      more = true;
      if (used[t] || used[other->second]) continue;
      used[t] = used[other->second] = 1;
      halve_edge(p, triangles, e, t, other->second);
    }
  }
}

/// Bisects the longest inner edges, at most one per triangle; returns false if none is too long.
bool halve_edges(std::vector<Flat>& p, std::vector<Triangle>& triangles, double length) {
  const std::map<FlatEdge, std::uint32_t> of = edges_of(triangles);
  std::vector<std::pair<double, FlatEdge>> too_long;
  for (const auto& [edge, t] : of) {
    const double d = squared_length(p[edge.first], p[edge.second]);
    if (edge.first > edge.second || !(d > length * length)) continue;
    const auto other = of.find({edge.second, edge.first});
    if (other == of.end()) continue;
    double longest = 0;
    for (const std::uint32_t k : {t, other->second})
      for (std::size_t i = 0; i < 3; ++i)
        longest = std::max(longest, squared_length(p[triangles[k][i]], p[triangles[k][(i + 1) % 3]]));
    if (d > kNearlyLongest * longest) too_long.emplace_back(d, edge);
  }
  if (too_long.empty()) return false;
  std::sort(too_long.begin(), too_long.end(),
            [](const auto& a, const auto& b) { return a.first != b.first ? a.first > b.first : a.second < b.second; });
  std::vector<std::uint8_t> used(triangles.size());
  for (const auto& [d, e] : too_long) {
    const std::uint32_t t = of.at(e), s = of.at({e.second, e.first});
    if (used[t] || used[s]) continue;
    used[t] = used[s] = 1;
    halve_edge(p, triangles, e, t, s);
  }
  return true;
}

}  // namespace

PlanarFill fill_planar(const std::vector<std::vector<std::array<double, 2>>>& loops, double length,
                       std::span<const std::uint8_t> apart) {
  PlanarFill fill;
  std::vector<Ring> outer, holes;
  for (const auto& loop : loops) {
    Ring ring;
    for (const Flat& x : loop) {
      ring.push_back(static_cast<std::uint32_t>(fill.points.size()));
      fill.points.push_back(x);
    }
    if (ring.size() < 3) continue;
    (ring_area(fill.points, ring) > 0 ? outer : holes).push_back(std::move(ring));
  }
  std::vector<std::vector<Ring>> within(outer.size());
  for (Ring& hole : holes) {  // assigns it to the smallest surrounding outer curve
    std::size_t best = outer.size();
    for (std::size_t k = 0; k < outer.size(); ++k)
      if (in_ring(fill.points, outer[k], fill.points[hole[0]]) &&
          (best == outer.size() || ring_area(fill.points, outer[k]) < ring_area(fill.points, outer[best])))
        best = k;
    if (best != outer.size()) within[best].push_back(std::move(hole));
  }
  for (std::size_t k = 0; k < outer.size(); ++k) {
    const auto rightmost = [&](const Ring& ring) {
      double x = -std::numeric_limits<double>::infinity();
      for (const std::uint32_t v : ring) x = std::max(x, fill.points[v][0]);
      return x;
    };
    std::stable_sort(within[k].begin(), within[k].end(),
                     [&](const Ring& a, const Ring& b) { return rightmost(a) > rightmost(b); });
    for (Ring& hole : within[k]) join_hole(fill.points, outer[k], std::move(hole));
    clip_ears(fill.points, outer[k], fill.triangles);
  }
  turn_edges(fill.points, fill.triangles);
  for (int round = 0; round < kMostHalvings && length > 0; ++round) {
    if (!halve_edges(fill.points, fill.triangles, length)) break;
    turn_edges(fill.points, fill.triangles);
  }
  keep_apart(fill.points, fill.triangles, apart);
  return fill;
}

}  // namespace sansmesh::inline v1
