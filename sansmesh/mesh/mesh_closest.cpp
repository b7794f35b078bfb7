#include "sansmesh/mesh/mesh_closest.h"

#include <algorithm>
#include <utility>

#include "sansmesh/core/parallel.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kLeaf = 4;
constexpr std::size_t kParallel = 16384;

/// Number of nodes of a subtree over n triangles, so that both halves can be built concurrently in place.
std::size_t count_nodes(std::size_t n) { return n <= kLeaf ? 1 : 1 + count_nodes(n / 2) + count_nodes(n - n / 2); }

double squared_distance_to(const Vec3f& lower, const Vec3f& upper, const Vec3& p) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double d = std::max({static_cast<double>(lower[k]) - p[k], p[k] - static_cast<double>(upper[k]), 0.0});
    sum += d * d;
  }
  return sum;
}

/// Inlined into both callers: the search does not need the part.
inline TrianglePoint locate(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  // Tests the Voronoi regions of corners and edges, then the interior.
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return {a, TrianglePart::a};
  const Vec3 bp = p - b;
  const double d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return {b, TrianglePart::b};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {a + ab * (d1 / (d1 - d3)), TrianglePart::ab};
  const Vec3 cp = p - c;
  const double d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return {c, TrianglePart::c};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {a + ac * (d2 / (d2 - d6)), TrianglePart::ca};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return {b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))), TrianglePart::bc};
  const double sum = va + vb + vc;
  if (!(sum > 0)) return {a, TrianglePart::a};
  return {a + ab * (vb / sum) + ac * (vc / sum), TrianglePart::inside};
}

}  // namespace

TrianglePoint locate_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  return locate(p, a, b, c);
}

Vec3 closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  return locate(p, a, b, c).point;
}

ClosestTriangle::ClosestTriangle(const TriangleMesh& mesh) {
  std::vector<Item> items;
  items.reserve(mesh.triangles.size());
  const std::size_t n = mesh.vertices.size();
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    if (t[0] >= n || t[1] >= n || t[2] >= n) continue;
    const Vec3f &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    if (!is_finite(a) || !is_finite(b) || !is_finite(c)) continue;
    items.push_back({a / 3 + b / 3 + c / 3, static_cast<std::uint32_t>(i)});
  }
  slots_.assign(mesh.triangles.size(), kNone);
  if (items.empty()) return;
  nodes_.resize(count_nodes(items.size()));
  corners_.resize(items.size());
  triangles_.resize(items.size());
  build(items, mesh, 0, 0, items.size());
}

void ClosestTriangle::build(std::vector<Item>& items, const TriangleMesh& mesh, std::size_t node, std::size_t first,
                            std::size_t last) {
  Node& self = nodes_[node];
  if (last - first <= kLeaf) {
    // A fixed order in the leaf, independent of the selection algorithm.
    std::sort(items.begin() + static_cast<std::ptrdiff_t>(first), items.begin() + static_cast<std::ptrdiff_t>(last),
              [](const Item& x, const Item& y) { return x.triangle < y.triangle; });
    Box3f box;
    for (std::size_t i = first; i < last; ++i) {
      const Triangle& t = mesh.triangles[items[i].triangle];
      corners_[i] = {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
      triangles_[i] = items[i].triangle;
      slots_[items[i].triangle] = static_cast<std::uint32_t>(i);
      box.extend(corners_[i].a), box.extend(corners_[i].b), box.extend(corners_[i].c);
    }
    self = {box.lower, box.upper, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last - first)};
    return;
  }
  Box3f centers;
  for (std::size_t i = first; i < last; ++i) centers.extend(items[i].center);
  const Vec3f size = centers.size();
  const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::size_t middle = first + (last - first) / 2;
  std::nth_element(
      items.begin() + static_cast<std::ptrdiff_t>(first), items.begin() + static_cast<std::ptrdiff_t>(middle),
      items.begin() + static_cast<std::ptrdiff_t>(last), [axis](const Item& x, const Item& y) {
        return x.center[axis] != y.center[axis] ? x.center[axis] < y.center[axis] : x.triangle < y.triangle;
      });
  const std::size_t left = node + 1, right = left + count_nodes(middle - first);
  const auto build_left = [&] { build(items, mesh, left, first, middle); };
  const auto build_right = [&] { build(items, mesh, right, middle, last); };
  if (last - first > kParallel)
    parallel_invoke(build_left, build_right);
  else
    build_left(), build_right();
  Box3f box{nodes_[left].lower, nodes_[left].upper};
  box.extend(Box3f{nodes_[right].lower, nodes_[right].upper});
  self = {box.lower, box.upper, static_cast<std::uint32_t>(right), 0};
}

ClosestTriangle::Hit ClosestTriangle::closest(const Vec3& query) const { return closest(query, {}); }

ClosestTriangle::Hit ClosestTriangle::closest(const Vec3& query, const Hit& hint) const {
  Hit best;
  if (empty() || !is_finite(query)) return best;
  if (hint.triangle == kNone) best.squared_distance = hint.squared_distance;
  const auto try_slot = [&](std::size_t slot) {
    const Corners& t = corners_[slot];
    const Vec3 point = closest_on_triangle(query, Vec3(t.a), Vec3(t.b), Vec3(t.c));
    const double distance = squared_norm(point - query);
    if (distance < best.squared_distance) best = {point, distance, triangles_[slot]};
  };
  if (hint.triangle < slots_.size() && slots_[hint.triangle] != kNone) try_slot(slots_[hint.triangle]);

  struct Waiting {
    double distance;
    std::uint32_t node;
  };
  Waiting stack[64];  // the tree is balanced: at most log2(2^32) levels
  std::size_t depth = 0;
  stack[depth++] = {squared_distance_to(nodes_[0].lower, nodes_[0].upper, query), 0};
  while (depth > 0) {
    const Waiting top = stack[--depth];
    if (top.distance >= best.squared_distance) continue;
    std::uint32_t at = top.node;
    while (nodes_[at].count == 0) {
      std::uint32_t near = at + 1, far = nodes_[at].first;
      double near_distance = squared_distance_to(nodes_[near].lower, nodes_[near].upper, query);
      double far_distance = squared_distance_to(nodes_[far].lower, nodes_[far].upper, query);
      if (far_distance < near_distance) std::swap(near, far), std::swap(near_distance, far_distance);
      if (far_distance < best.squared_distance) stack[depth++] = {far_distance, far};
      if (near_distance >= best.squared_distance) break;
      at = near;
    }
    const Node& leaf = nodes_[at];
    for (std::size_t i = 0; i < leaf.count; ++i) try_slot(leaf.first + i);
  }
  return best;
}

}  // namespace sansmesh::inline v1
