#include "sansmesh/deform/cuts/triangle_sheet.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "sansmesh/mesh/mesh_closest.h"
#include "sansmesh/search/equal_positions.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kLeafSize = 4;
constexpr double kSameCrossing = 1e-12;  // fraction of a segment: closer crossings are one
constexpr double kFlatEdge = 1e-9;       // sine of the angle between neighbours above which an edge is bent

/// Slab test of a segment and a box.
bool segment_meets(const Box3& box, const Vec3& a, const Vec3& b, double margin = 0) {
  double from = 0, to = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    const double d = b[k] - a[k];
    const double low = box.lower[k] - margin - a[k], high = box.upper[k] + margin - a[k];
    if (d == 0) {
      if (low > 0 || high < 0) return false;
      continue;
    }
    const double t0 = low / d, t1 = high / d;
    from = std::max(from, std::min(t0, t1)), to = std::min(to, std::max(t0, t1));
  }
  return from <= to + 1e-12;
}

/// Lower bound of the squared distance between the contents of two boxes.
double squared_gap(const Box3& box, const Box3& other) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double d = std::max({0.0, box.lower[k] - other.upper[k], other.lower[k] - box.upper[k]});
    sum += d * d;
  }
  return sum;
}

bool boxes_meet(const Box3& a, const Box3& b) { return squared_gap(a, b) == 0; }

/// Six times the volume of (a, b, p, q); its magnitude does not depend on the order of p and q.
double volume_of(const Vec3& a, const Vec3& b, const Vec3& p, const Vec3& q, bool swapped) {
  return swapped ? -dot(b - a, cross(q - a, p - a)) : dot(b - a, cross(p - a, q - a));
}

/// Whether the segment from p to q crosses the triangle, and where. n: normal of the triangle, of any length.
bool passes_through(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& n,
                    Vec3& point) {
  const double s0 = dot(p - a, n), s1 = dot(q - a, n);
  if ((s0 >= 0) == (s1 >= 0)) return false;
  const double x = volume_of(p, q, a, b, false), y = volume_of(p, q, b, c, false), z = volume_of(p, q, c, a, false);
  if (!((x >= 0 && y >= 0 && z >= 0) || (x <= 0 && y <= 0 && z <= 0))) return false;
  point = p + (q - p) * (std::abs(s0) / (std::abs(s0) + std::abs(s1)));
  return true;
}

struct SegmentPair {
  double squared_distance, s, t;
};

/// The closest points of two segments (Ericson 2005, section 5.1.9).
SegmentPair closest_of_segments(const Vec3& a, const Vec3& b, const Vec3& p, const Vec3& q) {
  const Vec3 u = b - a, v = q - p, w = a - p;
  const double uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), uw = dot(u, w), vw = dot(v, w);
  double s = 0, t = 0;
  if (vv > 0) {
    const double det = uu * vv - uv * uv;
    s = uu > 0 && det > 1e-14 * uu * vv ? std::clamp((uv * vw - uw * vv) / det, 0.0, 1.0) : 0;
    t = (uv * s + vw) / vv;
    if (t < 0 || t > 1) {
      t = std::clamp(t, 0.0, 1.0);
      s = uu > 0 ? std::clamp((uv * t - uw) / uu, 0.0, 1.0) : 0;
    }
  } else if (uu > 0) {
    s = std::clamp(-uw / uu, 0.0, 1.0);
  }
  return {squared_norm(a + u * s - p - v * t), s, t};
}

Box3 box_around(const Vec3& a, const Vec3& b) {
  Box3 box;
  box.extend(a), box.extend(b);
  return box;
}

}  // namespace

template <class BoxOf>
void TriangleSheet::build(Tree& tree, std::size_t first, std::size_t last, const BoxOf& box_of) {
  const std::size_t node = tree.nodes.size();
  tree.nodes.emplace_back();
  Box3 box, centers;
  for (std::size_t i = first; i < last; ++i) {
    box.extend(box_of(tree.entries[i]));
    centers.extend(box_of(tree.entries[i]).center());
  }
  tree.nodes[node].box = box;
  if (last - first <= kLeafSize) {
    tree.nodes[node].first = static_cast<std::uint32_t>(first);
    tree.nodes[node].count = static_cast<std::uint32_t>(last - first);
    return;
  }
  const Vec3 size = centers.size();
  const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const std::size_t middle = (first + last) / 2;
  const auto begin = tree.entries.begin();
  std::nth_element(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(middle),
                   begin + static_cast<std::ptrdiff_t>(last), [&](std::uint32_t i, std::uint32_t j) {
                     const double a = box_of(i).center()[axis], b = box_of(j).center()[axis];
                     return a != b ? a < b : i < j;
                   });
  build(tree, first, middle, box_of);
  tree.nodes[node].first = static_cast<std::uint32_t>(tree.nodes.size());
  build(tree, middle, last, box_of);
}

/// Calls use(entry) for the entries of leaves accepted by enters(box); stops when use returns true.
template <class Enters, class Use>
void TriangleSheet::visit(const Tree& tree, const Enters& enters, const Use& use) {
  if (tree.nodes.empty()) return;
  std::array<std::uint32_t, 64> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t at = stack[--depth];
    const Node& node = tree.nodes[at];
    if (!enters(node.box)) continue;
    if (node.count == 0) {
      stack[depth++] = node.first;
      stack[depth++] = at + 1;
      continue;
    }
    for (std::uint32_t i = 0; i < node.count; ++i)
      if (use(tree.entries[node.first + i])) return;
  }
}

TriangleSheet::TriangleSheet(const TriangleMesh& mesh) {
  const std::vector<std::uint32_t> first = first_equal_positions(mesh.vertices);
  points_.reserve(mesh.vertices.size());
  for (const Vec3f& v : mesh.vertices) points_.push_back(mesh.origin + Vec3(v));
  struct Side {
    int count = 0;
    Vec3 normal;
    bool bent = false;
  };
  std::map<std::array<std::uint32_t, 2>, Side> edges;
  for (const Triangle& t : mesh.triangles) {
    Triangle merged{};
    bool good = true;
    for (std::size_t k = 0; k < 3 && good; ++k) {
      good = t[k] < points_.size() && is_finite(points_[t[k]]);
      if (good) merged[k] = first[t[k]];
    }
    if (!good) continue;
    const Vec3 &a = points_[merged[0]], &b = points_[merged[1]], &c = points_[merged[2]];
    const Vec3 normal = normalized(cross(b - a, c - a));
    if (normal == Vec3{}) continue;
    triangles_.push_back(merged);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t p = merged[k], q = merged[(k + 1) % 3];
      Side& side = edges[{std::min(p, q), std::max(p, q)}];
      if (side.count++ == 0) side.normal = normal;
      side.bent = side.bent || side.count > 2 || norm(cross(normal, side.normal)) > kFlatEdge;
      box_.extend(points_[p]);
    }
  }
  for (const auto& [edge, side] : edges) {
    if (side.count == 1) border_.push_back(edge);
    if (side.count == 1 || side.bent) bent_.push_back(edge);
  }
  const auto fill = [](Tree& tree, std::size_t n, const auto& box_of) {
    for (std::size_t i = 0; i < n; ++i) tree.entries.push_back(static_cast<std::uint32_t>(i));
    if (n > 0) build(tree, 0, n, box_of);
  };
  fill(tree_, triangles_.size(), [&](std::uint32_t i) {
    Box3 box = box_around(points_[triangles_[i][0]], points_[triangles_[i][1]]);
    box.extend(points_[triangles_[i][2]]);
    return box;
  });
  fill(border_tree_, border_.size(),
       [&](std::uint32_t i) { return box_around(points_[border_[i][0]], points_[border_[i][1]]); });
  fill(bent_tree_, bent_.size(),
       [&](std::uint32_t i) { return box_around(points_[bent_[i][0]], points_[bent_[i][1]]); });
}

std::array<Vec3, 3> TriangleSheet::corners(std::size_t triangle) const {
  const Triangle& t = triangles_[triangle];
  return {points_[t[0]], points_[t[1]], points_[t[2]]};
}

bool TriangleSheet::hit(const Vec3& a, const Vec3& b, std::uint32_t triangle, double& share) const {
  const Triangle& t = triangles_[triangle];
  const Vec3 &p = points_[t[0]], &q = points_[t[1]], &r = points_[t[2]];
  const Vec3 n = cross(q - p, r - p);
  const double s0 = dot(a - p, n), s1 = dot(b - p, n);
  if ((s0 >= 0) == (s1 >= 0)) return false;
  const double x = volume_of(a, b, p, q, t[0] > t[1]), y = volume_of(a, b, q, r, t[1] > t[2]),
               z = volume_of(a, b, r, p, t[2] > t[0]);
  if (!((x >= 0 && y >= 0 && z >= 0) || (x <= 0 && y <= 0 && z <= 0))) return false;
  share = std::abs(s0) / (std::abs(s0) + std::abs(s1));
  return true;
}

bool TriangleSheet::crosses(const Vec3& a, const Vec3& b) const {
  bool found = false;
  double share = 0;
  visit(
      tree_, [&](const Box3& box) { return segment_meets(box, a, b); },
      [&](std::uint32_t i) { return found = hit(a, b, i, share); });
  return found;
}

void TriangleSheet::crossings(const Vec3& a, const Vec3& b, std::vector<Crossing>& found) const {
  const std::size_t begin = found.size();
  visit(
      tree_, [&](const Box3& box) { return segment_meets(box, a, b); },
      [&](std::uint32_t i) {
        double share = 0;
        if (hit(a, b, i, share)) found.push_back({share, a + (b - a) * share, i});
        return false;
      });
  const auto from = found.begin() + static_cast<std::ptrdiff_t>(begin);
  std::sort(from, found.end(), [](const Crossing& c, const Crossing& d) {
    return c.share != d.share ? c.share < d.share : c.triangle < d.triangle;
  });
  found.erase(std::unique(from, found.end(),
                          [](const Crossing& c, const Crossing& d) { return d.share - c.share < kSameCrossing; }),
              found.end());
}

void TriangleSheet::bends(const Vec3& a, const Vec3& b, const Vec3& c, double width, std::vector<Bend>& found) const {
  const Vec3 n = cross(b - a, c - a);
  visit(
      bent_tree_, [&](const Box3& box) { return segment_meets(box, a, c, width); },
      [&](std::uint32_t i) {
        const Vec3 &p = points_[bent_[i][0]], &q = points_[bent_[i][1]];
        Vec3 point;
        if (passes_through(p, q, a, b, c, n, point)) found.push_back({point, p, q});
        return false;
      });
}

void TriangleSheet::border_points(const std::array<Vec3, 3>& triangle, std::vector<Vec3>& found) const {
  const Vec3 &a = triangle[0], &b = triangle[1], &c = triangle[2];
  Box3 box = box_around(a, b);
  box.extend(c);
  const Vec3 n = cross(b - a, c - a);
  visit(
      border_tree_, [&](const Box3& other) { return boxes_meet(box, other); },
      [&](std::uint32_t i) {
        const Vec3 &p = points_[border_[i][0]], &q = points_[border_[i][1]];
        Vec3 point{};
        if (passes_through(p, q, a, b, c, n, point)) found.push_back(point);
        return false;
      });
}

TriangleSheet::Nearest TriangleSheet::nearest(const Vec3& a, const Vec3& b, double limit) const {
  Nearest best;
  best.distance = limit;
  double least = limit * limit;
  bool any = false;
  const auto take = [&](double squared, double share, const Vec3& point) {
    if (!(squared < least)) return;
    least = squared, best.share = share, best.point = point, any = true;
  };
  const Box3 box = box_around(a, b);
  visit(
      tree_, [&](const Box3& other) { return squared_gap(box, other) < least; },
      [&](std::uint32_t i) {
        const Triangle& t = triangles_[i];
        const Vec3 &p = points_[t[0]], &q = points_[t[1]], &r = points_[t[2]];
        double share = 0;
        if (hit(a, b, i, share)) {
          take(0, share, a + (b - a) * share);
          return false;
        }
        const Vec3 on_a = closest_on_triangle(a, p, q, r);
        take(squared_norm(a - on_a), 0, on_a);
        if (a == b) return false;
        const Vec3 on_b = closest_on_triangle(b, p, q, r);
        take(squared_norm(b - on_b), 1, on_b);
        for (std::size_t k = 0; k < 3; ++k) {
          const Vec3 &c = points_[t[k]], &d = points_[t[(k + 1) % 3]];
          const SegmentPair pair = closest_of_segments(a, b, c, d);
          take(pair.squared_distance, pair.s, c + (d - c) * pair.t);
        }
        return false;
      });
  best.distance = any ? std::sqrt(least) : std::numeric_limits<double>::infinity();
  return best;
}

TriangleSheet::Nearest TriangleSheet::nearest_border(const Vec3& x, double limit) const {
  Nearest best;
  double least = limit * limit;
  bool any = false;
  const Box3 box = box_around(x, x);
  visit(
      border_tree_, [&](const Box3& other) { return squared_gap(box, other) < least; },
      [&](std::uint32_t i) {
        const Vec3 &p = points_[border_[i][0]], &q = points_[border_[i][1]];
        const double length = squared_norm(q - p);
        const Vec3 on = p + (q - p) * std::clamp(dot(x - p, q - p) / length, 0.0, 1.0);
        const double squared = squared_norm(x - on);
        if (squared < least) least = squared, best.point = on, any = true;
        return false;
      });
  best.distance = any ? std::sqrt(least) : std::numeric_limits<double>::infinity();
  return best;
}

}  // namespace sansmesh::inline v1
