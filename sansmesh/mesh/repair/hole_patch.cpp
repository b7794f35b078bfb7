#include "sansmesh/mesh/repair/hole_patch.h"
#include "sansmesh/core/edge_key.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <map>
#include <queue>
#include <unordered_set>
#include <utility>

namespace sansmesh::inline v1::detail {
namespace {

constexpr std::uint32_t kNoOther = ~std::uint32_t{0};
constexpr double kForever = std::numeric_limits<double>::infinity();
/// Margin of a flip against rounding; and bounds of cotangent weights, so that slivers have little influence.
constexpr double kFlipMargin = 1e-4, kLeastWeight = 1e-3, kMostWeight = 20;
constexpr int kMostRefinements = 40, kMostFlipRounds = 30;
constexpr double kSplitAbove = 1.4142;
constexpr double kClippedLength = 0.05;  // turn (1 − cos) as bad as an edge as long as those of the loop

/// Cost of filling a part of the loop: the number of edges that the mesh already has, then the largest angle, then the
/// area.
struct PatchCost {
  std::uint32_t existing = kNoOther;
  double angle = kForever, area = kForever;
  friend bool operator<(const PatchCost& a, const PatchCost& b) {
    if (a.existing != b.existing) return a.existing < b.existing;
    return a.angle != b.angle ? a.angle < b.angle : a.area < b.area;
  }
};

Vec3 doubled_normal(const Vec3& a, const Vec3& b, const Vec3& c) { return cross(b - a, c - a); }

/// Angle measure 1 − cos between the normals of two triangles, 0..2; 2 for triangles without a normal.
double turn_between(const Vec3& a, const Vec3& b) {
  const double length = std::sqrt(squared_norm(a) * squared_norm(b));
  return length > 0 ? 1 - dot(a, b) / length : 2;
}

/// Triangulates the whole loop by dynamic programming.
std::vector<PatchTriangle> triangulate_whole(const HoleRim& rim) {
  const std::size_t n = rim.x.size();
  std::vector<PatchCost> cost(n * n);
  std::vector<std::uint32_t> tip(n * n, kNoOther);
  const auto at = [n](std::size_t i, std::size_t k) { return i * n + k; };
  for (std::size_t i = 0; i + 1 < n; ++i) cost[at(i, i + 1)] = {0, 0, 0};
  // Normal of the triangle beyond the edge from i to k: in the mesh or in the filling.
  const auto across = [&](std::size_t i, std::size_t k) {
    if (k == i + 1) return doubled_normal(rim.x[k], rim.x[i], rim.beside[i]);
    return doubled_normal(rim.x[i], rim.x[tip[at(i, k)]], rim.x[k]);
  };
  for (std::size_t wide = 2; wide < n; ++wide)
    for (std::size_t i = 0; i + wide < n; ++i) {
      const std::size_t k = i + wide;
      const bool last = i == 0 && k == n - 1;
      const bool exists = !last && rim.joined(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(k));
      PatchCost best;
      for (std::size_t m = i + 1; m < k; ++m) {
        const PatchCost &left = cost[at(i, m)], &right = cost[at(m, k)];
        const std::uint32_t existing = left.existing + right.existing + (exists ? 1 : 0);
        const double sides = std::max(left.angle, right.angle);
        if (existing > best.existing || (existing == best.existing && sides > best.angle)) continue;
        const Vec3 normal = doubled_normal(rim.x[i], rim.x[m], rim.x[k]);
        PatchCost whole{existing,
                        std::max({sides, turn_between(normal, across(i, m)), turn_between(normal, across(m, k))}),
                        left.area + right.area + norm(normal)};
        if (last)
          whole.angle = std::max(whole.angle, turn_between(normal, doubled_normal(rim.x[0], rim.x[k], rim.beside[k])));
        if (whole < best) best = whole, tip[at(i, k)] = static_cast<std::uint32_t>(m);
      }
      cost[at(i, k)] = best;
    }
  std::vector<PatchTriangle> all;
  if (n < 3) return all;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> open{{0, static_cast<std::uint32_t>(n - 1)}};
  while (!open.empty()) {
    const auto [i, k] = open.back();
    open.pop_back();
    if (k == i + 1) continue;
    const std::uint32_t m = tip[at(i, k)];
    all.push_back({i, m, k});
    open.emplace_back(i, m), open.emplace_back(m, k);
  }
  return all;
}

/// Loop from which vertices are clipped by triangles over their neighbours.
struct ClippedLoop {
  const HoleRim& rim;
  std::vector<std::uint32_t> before, after;
  std::vector<Vec3> beside;  ///< opposite corner of the triangle at the edge from a vertex to the next one

  explicit ClippedLoop(const HoleRim& r) : rim(r), beside(r.beside.begin(), r.beside.end()) {
    const auto n = static_cast<std::uint32_t>(r.x.size());
    for (std::uint32_t v = 0; v < n; ++v)
      before.push_back(v > 0 ? v - 1 : n - 1), after.push_back(v + 1 < n ? v + 1 : 0);
  }

  /// Turn against the triangles at both edges, and the new edge's length in edges of the loop. Edges that the mesh
  /// already has come last.
  double cost(std::uint32_t v, double edge) const {
    const std::uint32_t a = before[v], b = after[v];
    if (rim.joined(a, b)) return kForever;
    const Vec3 normal = doubled_normal(rim.x[a], rim.x[v], rim.x[b]);
    const double turn = std::max(turn_between(normal, doubled_normal(rim.x[v], rim.x[a], beside[a])),
                                 turn_between(normal, doubled_normal(rim.x[b], rim.x[v], beside[v])));
    return turn + kClippedLength * norm(rim.x[b] - rim.x[a]) / edge;
  }

  PatchTriangle clip(std::uint32_t v) {
    const std::uint32_t a = before[v], b = after[v];
    after[a] = b, before[b] = a;
    beside[a] = rim.x[v];
    return {a, v, b};
  }
};

/// Clips vertices until kWholeLoop are left, then triangulates the rest.
std::vector<PatchTriangle> triangulate_long(const HoleRim& rim) {
  ClippedLoop loop(rim);
  const auto n = static_cast<std::uint32_t>(rim.x.size());
  double edge = 0;
  for (std::uint32_t v = 0; v < n; ++v) edge += norm(rim.x[loop.after[v]] - rim.x[v]) / n;
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  std::vector<double> cost(n);
  const auto look = [&](std::uint32_t v) { queue.emplace(cost[v] = loop.cost(v, std::max(edge, 1e-300)), v); };
  for (std::uint32_t v = 0; v < n; ++v) look(v);
  std::vector<PatchTriangle> all;
  for (std::size_t left = n; left > kWholeLoop;) {
    const auto [c, v] = queue.top();
    queue.pop();
    if (c != cost[v] || loop.after[loop.before[v]] != v) continue;  // outdated, or clipped
    all.push_back(loop.clip(v));
    --left;
    look(loop.before[v]), look(loop.after[v]);
  }
  std::vector<std::uint32_t> rest;
  const std::uint32_t first = all.back()[0];
  for (std::uint32_t v = first; rest.empty() || v != first; v = loop.after[v]) rest.push_back(v);
  std::vector<Vec3> x, beside;
  for (const std::uint32_t v : rest) x.push_back(rim.x[v]), beside.push_back(loop.beside[v]);
  const auto joined = [&](std::uint32_t i, std::uint32_t k) { return rim.joined(rest[i], rest[k]); };
  for (const PatchTriangle& t : triangulate_whole({x, beside, joined}))
    all.push_back({rest[t[0]], rest[t[1]], rest[t[2]]});
  return all;
}

/// Triangles with neighbours, for edge flips.
struct PatchTopology {
  std::vector<PatchTriangle>& triangles;
  std::vector<Vec3>& x;
  std::size_t loop;
  const std::function<bool(std::uint32_t, std::uint32_t)>& joined;
  std::vector<std::array<std::uint32_t, 3>> beyond;  // the triangle across the edge from corner k to the next
  std::unordered_set<std::uint64_t> edges;

  void find_neighbours() {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> keys;
    for (std::uint32_t t = 0; t < triangles.size(); ++t)
      for (std::uint32_t k = 0; k < 3; ++k)
        keys.emplace_back(edge_key(triangles[t][k], triangles[t][(k + 1) % 3]), 3 * t + k);
    std::sort(keys.begin(), keys.end());
    beyond.assign(triangles.size(), {kNoOther, kNoOther, kNoOther});
    edges.clear();
    for (std::size_t i = 0; i < keys.size(); ++i) {
      edges.insert(keys[i].first);
      if (i + 1 < keys.size() && keys[i].first == keys[i + 1].first) {
        const std::uint32_t a = keys[i].second, b = keys[i + 1].second;
        beyond[a / 3][a % 3] = b / 3, beyond[b / 3][b % 3] = a / 3;
      }
    }
  }

  void relink(std::uint32_t t, std::uint32_t from, std::uint32_t to) {
    if (t == kNoOther) return;
    for (std::uint32_t& b : beyond[t])
      if (b == from) {
        b = to;
        return;
      }
  }

  double angle_at(std::uint32_t corner, std::uint32_t a, std::uint32_t b) const {
    const Vec3 u = x[a] - x[corner], v = x[b] - x[corner];
    return std::atan2(norm(cross(u, v)), dot(u, v));
  }

  /// Flips edge k of triangle t if that improves the Delaunay criterion.
  bool turn(std::uint32_t t, std::size_t k) {
    const std::uint32_t s = beyond[t][k];
    if (s == kNoOther) return false;
    const std::uint32_t a = triangles[t][k], b = triangles[t][(k + 1) % 3], c = triangles[t][(k + 2) % 3];
    std::size_t j = 0;
    while (j < 3 && triangles[s][j] != b) ++j;
    if (j == 3 || triangles[s][(j + 1) % 3] != a) return false;
    const std::uint32_t d = triangles[s][(j + 2) % 3];
    if (c == d || angle_at(c, a, b) + angle_at(d, a, b) < 3.14159265358979 + kFlipMargin) return false;
    if (edges.contains(edge_key(c, d)) || (c < loop && d < loop && joined(c, d))) return false;
    const Vec3 middle = normalized(doubled_normal(x[a], x[b], x[c])) + normalized(doubled_normal(x[b], x[a], x[d]));
    if (!(dot(doubled_normal(x[a], x[d], x[c]), middle) > 0 && dot(doubled_normal(x[d], x[b], x[c]), middle) > 0))
      return false;
    const std::uint32_t bc = beyond[t][(k + 1) % 3], ca = beyond[t][(k + 2) % 3];
    const std::uint32_t ad = beyond[s][(j + 1) % 3], db = beyond[s][(j + 2) % 3];
    edges.erase(edge_key(a, b)), edges.insert(edge_key(c, d));
    triangles[t] = {a, d, c}, beyond[t] = {ad, s, ca};
    triangles[s] = {d, b, c}, beyond[s] = {db, bc, t};
    relink(ad, s, t), relink(bc, t, s);
    return true;
  }

  void turn_all() {
    for (int round = 0; round < kMostFlipRounds; ++round) {
      bool any = false;
      for (std::uint32_t t = 0; t < triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) any |= turn(t, k);
      if (!any) return;
    }
  }
};

}  // namespace

std::vector<PatchTriangle> triangulate_hole(const HoleRim& rim) {
  if (rim.x.size() < 3) return {};
  return rim.x.size() <= kWholeLoop ? triangulate_whole(rim) : triangulate_long(rim);
}

void split_existing_edges(std::vector<PatchTriangle>& triangles, std::vector<Vec3>& x, std::vector<double>& scale,
                          const std::function<bool(std::uint32_t, std::uint32_t)>& joined) {
  const auto loop = static_cast<std::uint32_t>(x.size());
  std::map<std::uint64_t, std::uint32_t> middle;  // new vertex of each edge
  for (const PatchTriangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if ((a + 1) % loop == b || (b + 1) % loop == a || !joined(a, b)) continue;
      const auto [at, fresh] = middle.try_emplace(edge_key(a, b), static_cast<std::uint32_t>(x.size()));
      if (fresh) x.push_back((x[a] + x[b]) / 4), scale.push_back((scale[a] + scale[b]) / 2);
      x[at->second] += x[t[(k + 2) % 3]] / 4;
    }
  if (middle.empty()) return;
  std::vector<PatchTriangle> all;
  for (const PatchTriangle& t : triangles) {
    std::vector<std::uint32_t> corners;  // with the new vertices
    for (std::size_t k = 0; k < 3; ++k) {
      corners.push_back(t[k]);
      if (const auto at = middle.find(edge_key(t[k], t[(k + 1) % 3])); at != middle.end())
        corners.push_back(at->second);
    }
    // Cuts off a corner between new vertices, or fans out from the first new vertex.
    std::size_t start = 0;
    while (start < corners.size() && corners[start] < loop) ++start;
    std::rotate(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(start % corners.size()), corners.end());
    if (corners.size() == 6) {
      for (const std::size_t k : {1u, 3u, 5u}) all.push_back({corners[k - 1], corners[k], corners[(k + 1) % 6]});
      all.push_back({corners[0], corners[2], corners[4]});
      continue;
    }
    for (std::size_t k = 1; k + 1 < corners.size(); ++k) all.push_back({corners[0], corners[k], corners[k + 1]});
  }
  triangles = std::move(all);
}

void refine_patch(std::vector<PatchTriangle>& triangles, std::vector<Vec3>& x, std::vector<double>& scale,
                  std::size_t loop, std::size_t most, const std::function<bool(std::uint32_t, std::uint32_t)>& joined) {
  PatchTopology topology{triangles, x, loop, joined, {}, {}};
  topology.find_neighbours();
  topology.turn_all();
  for (int round = 0; round < kMostRefinements; ++round) {
    const std::size_t before = triangles.size();
    for (std::size_t i = 0; i < before && x.size() < loop + most; ++i) {
      const PatchTriangle t = triangles[i];
      const Vec3 middle = (x[t[0]] + x[t[1]] + x[t[2]]) / 3;
      const double wanted = (scale[t[0]] + scale[t[1]] + scale[t[2]]) / 3;
      bool large = true;
      for (const std::uint32_t v : t) large &= kSplitAbove * norm(middle - x[v]) > std::max(wanted, scale[v]);
      if (!large) continue;
      const auto v = static_cast<std::uint32_t>(x.size());
      x.push_back(middle), scale.push_back(wanted);
      triangles[i] = {t[0], t[1], v};
      triangles.push_back({t[1], t[2], v});
      triangles.push_back({t[2], t[0], v});
    }
    if (triangles.size() == before) break;
    topology.find_neighbours();
    topology.turn_all();
  }
}

bool fair_patch(std::span<const PatchTriangle> triangles, std::span<const PatchTriangle> outside,
                std::span<const Vec3> around, std::size_t loop, std::vector<Vec3>& x) {
  const std::size_t n = x.size(), free = n - loop;
  if (free == 0) return true;
  const auto at = [&](std::uint32_t v) -> const Vec3& { return v < n ? x[v] : around[v - n]; };
  // Edges from the patch vertices with cotangent weights, and the areas of the stars.
  struct Entry {
    std::uint32_t v, w;
    double weight;
  };
  std::vector<Entry> entries;
  std::vector<double> area(n, 0);
  for (const auto list : {triangles, outside})
    for (const PatchTriangle& t : list) {
      const double doubled = norm(doubled_normal(at(t[0]), at(t[1]), at(t[2])));
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
        const double cotangent = doubled > 0 ? dot(at(a) - at(c), at(b) - at(c)) / doubled : kMostWeight;
        const double w = std::clamp(cotangent, kLeastWeight, kMostWeight);
        if (a < n) entries.push_back({a, b, w}), area[a] += doubled;
        if (b < n) entries.push_back({b, a, w});
      }
    }
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& a, const Entry& b) { return a.v != b.v ? a.v < b.v : a.w < b.w; });
  std::vector<Eigen::Triplet<double>> triplets;
  const auto size = static_cast<Eigen::Index>(free);
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(size, 3);
  double mean = 0;
  for (const double one : area) mean += one;
  mean /= static_cast<double>(n);
  std::vector<std::pair<std::uint32_t, double>> row;
  for (std::size_t i = 0; i < entries.size();) {
    const std::uint32_t v = entries[i].v;
    row.assign(1, {v, 0});
    for (; i < entries.size() && entries[i].v == v; ++i) {
      if (row.size() > 1 && row.back().first == entries[i].w)
        row.back().second += entries[i].weight;
      else
        row.emplace_back(entries[i].w, entries[i].weight);
      row[0].second -= entries[i].weight;
    }
    const double importance = mean / std::max(area[v], 1e-3 * mean);
    for (const auto& [a, of_a] : row) {
      if (a < loop || a >= n) continue;
      const auto r = static_cast<Eigen::Index>(a - loop);
      for (const auto& [b, of_b] : row) {
        const double product = importance * of_a * of_b;
        if (b >= loop && b < n) {
          triplets.emplace_back(r, static_cast<Eigen::Index>(b - loop), product);
        } else {
          const Vec3& p = at(b);
          right(r, 0) -= product * p.x, right(r, 1) -= product * p.y, right(r, 2) -= product * p.z;
        }
      }
    }
  }
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  if (solver.info() != Eigen::Success) return false;
  const Eigen::MatrixX3d found = solver.solve(right);
  if (!found.allFinite()) return false;
  for (std::size_t v = 0; v < free; ++v) {
    const auto r = static_cast<Eigen::Index>(v);
    x[loop + v] = {found(r, 0), found(r, 1), found(r, 2)};
  }
  return true;
}

}  // namespace sansmesh::inline v1::detail
