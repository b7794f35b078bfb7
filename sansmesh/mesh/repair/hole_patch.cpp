#include "sansmesh/mesh/repair/hole_patch.h"
#include "sansmesh/core/edge_key.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
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

/// Cost of filling a part of the loop: the larger angle, then the area.
struct PatchCost {
  double angle = kForever, area = kForever;
  friend bool operator<(const PatchCost& a, const PatchCost& b) {
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
  for (std::size_t i = 0; i + 1 < n; ++i) cost[at(i, i + 1)] = {0, 0};
  // Normal of the triangle beyond the edge from i to k: in the mesh or in the filling.
  const auto across = [&](std::size_t i, std::size_t k) {
    if (k == i + 1) return doubled_normal(rim.x[k], rim.x[i], rim.beside[i]);
    return doubled_normal(rim.x[i], rim.x[tip[at(i, k)]], rim.x[k]);
  };
  for (std::size_t wide = 2; wide < n; ++wide)
    for (std::size_t i = 0; i + wide < n; ++i) {
      const std::size_t k = i + wide;
      const bool last = i == 0 && k == n - 1;
      if (!last && rim.joined(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(k))) continue;
      PatchCost best;
      for (std::size_t m = i + 1; m < k; ++m) {
        const PatchCost &left = cost[at(i, m)], &right = cost[at(m, k)];
        const double sides = std::max(left.angle, right.angle);
        if (sides > best.angle || sides == kForever) continue;
        const Vec3 normal = doubled_normal(rim.x[i], rim.x[m], rim.x[k]);
        PatchCost whole{std::max({sides, turn_between(normal, across(i, m)), turn_between(normal, across(m, k))}),
                        left.area + right.area + norm(normal)};
        if (last)
          whole.angle = std::max(whole.angle, turn_between(normal, doubled_normal(rim.x[0], rim.x[k], rim.beside[k])));
        if (whole < best) best = whole, tip[at(i, k)] = static_cast<std::uint32_t>(m);
      }
      cost[at(i, k)] = best;
    }
  std::vector<PatchTriangle> all;
  if (n < 3 || cost[at(0, n - 1)].angle == kForever) return all;
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

/// Triangulates the loop of some vertices.
std::vector<PatchTriangle> triangulate_some(const HoleRim& rim, const std::vector<std::uint32_t>& some,
                                            const std::vector<Vec3>& beside, bool closing_is_free) {
  std::vector<Vec3> x;
  x.reserve(some.size());
  for (const std::uint32_t v : some) x.push_back(rim.x[v]);
  const std::size_t n = rim.x.size();
  const auto joined = [&](std::uint32_t i, std::uint32_t k) {
    const std::uint32_t a = some[i], b = some[k];
    if ((a + 1) % n == b || (b + 1) % n == a) return false;
    return rim.joined(a, b);
  };
  // Its own edges may also exist in the mesh.
  for (std::uint32_t i = 0; i + (closing_is_free ? 1 : 0) < some.size(); ++i)
    if (joined(i, static_cast<std::uint32_t>((i + 1) % some.size()))) return {};
  std::vector<PatchTriangle> all = triangulate_whole({x, beside, joined});
  for (PatchTriangle& t : all)
    for (std::uint32_t& v : t) v = some[v];
  return all;
}

/// Triangulates a coarse loop first, then the parts between its edges and the loop.
std::vector<PatchTriangle> triangulate_long(const HoleRim& rim, std::uint32_t stride, std::uint32_t offset) {
  const auto n = static_cast<std::uint32_t>(rim.x.size());
  std::vector<std::uint32_t> coarse;
  std::vector<Vec3> beside;
  for (std::uint32_t v = offset; v < n; v += stride) coarse.push_back(v);
  for (std::size_t j = 0; j < coarse.size(); ++j) {
    const std::uint32_t next = j + 1 < coarse.size() ? coarse[j + 1] : coarse[0] + n;
    beside.push_back(rim.beside[(coarse[j] + next) / 2 % n]);
  }
  std::vector<PatchTriangle> all = triangulate_some(rim, coarse, beside, false);
  if (all.empty()) return all;
  // Opposite corner in the coarse filling at each coarse edge.
  std::vector<std::uint32_t> opposite(n, 0);
  for (const PatchTriangle& t : all)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      const auto j = static_cast<std::size_t>(std::lower_bound(coarse.begin(), coarse.end(), a) - coarse.begin());
      if (coarse[(j + 1) % coarse.size()] == b) opposite[a] = t[(k + 2) % 3];
    }
  for (std::size_t j = 0; j < coarse.size(); ++j) {
    const std::uint32_t end = j + 1 < coarse.size() ? coarse[j + 1] : coarse[0] + n;
    std::vector<std::uint32_t> part;
    std::vector<Vec3> around;
    for (std::uint32_t v = coarse[j]; v <= end; ++v) {
      part.push_back(v % n);
      around.push_back(v < end ? rim.beside[v % n] : rim.x[opposite[coarse[j]]]);
    }
    if (part.size() < 3) continue;
    const std::vector<PatchTriangle> strip = triangulate_some(rim, part, around, true);
    if (strip.empty()) return {};
    all.insert(all.end(), strip.begin(), strip.end());
  }
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
  const std::size_t n = rim.x.size();
  if (n < 3) return {};
  if (n <= kWholeLoop) return triangulate_whole(rim);
  const auto stride = static_cast<std::uint32_t>((n + kWholeLoop - 1) / kWholeLoop);
  for (std::uint32_t offset = 0; offset < stride; ++offset) {
    std::vector<PatchTriangle> all = triangulate_long(rim, stride, offset);
    if (!all.empty()) return all;
  }
  return {};
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
