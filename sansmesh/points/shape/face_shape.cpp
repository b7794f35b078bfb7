#include "sansmesh/points/shape/face_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/median.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/data/triangles.h"
#include "sansmesh/points/sampling/sample_faces.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

/// Largest share of edges without a second triangle or with two triangles of the same direction.
constexpr double kOddEdges = 0.01;
/// Parts with less than this share of the volume are not classified.
constexpr double kTinyPart = 1e-6;
/// More cavities than this indicate randomly oriented faces.
constexpr std::size_t kMostCavities = 1000;

constexpr std::size_t kEnoughVertices = 1000;
constexpr double kLongEdge = 5;        // in spacings of the vertices
constexpr double kSparseShare = 0.05;  // largest share of the area in triangles with such edges
/// Largest share of the area with a near opposite side: of any mesh, and of a closed one, which bounds a solid.
constexpr double kThinShare = 0.03, kThinShareOfClosed = 0.003;
/// For meshes that are too thin: samples across the thickness of a completely thin mesh (fewer if less of it is thin,
/// as they are distributed over all of it); least number of samples per vertex; and largest number per vertex of a
/// large mesh.
constexpr double kAcross = 8;
/// For closed meshes: samples across the thickness, whatever the share of thin parts.
constexpr double kAcrossClosed = 4;
constexpr double kLeastOfVertex = 2;
constexpr std::size_t kMostOfVertex = 2;

/// Sharp edges: of triangles that differ by more than 30°. A mesh has creases if at least this share of its vertices is
/// on sharp edges, and most of these have two such edges, in line within 25°. Then its faces are sampled, with so many
/// samples per vertex.
constexpr float kCreaseCosine = 0.866f, kStraightCosine = -0.906f;
constexpr double kCreasedShare = 0.02, kStraightShare = 0.7;
constexpr double kOfCreasedVertex = 10;

constexpr std::size_t kProbes = 4000;
/// Largest depth of the opposite side, and largest lateral distance of its vertices, in longest edges.
constexpr float kDepth = 1.5f, kBeside = 0.6f;
/// Largest cosine between normals of opposite sides.
constexpr float kOtherSide = -0.3f;
/// Least cosine between a face normal and the sum of the normals at its three corners.
constexpr float kOwnSide = 0.9f;

bool is_triangle(const PointSet& mesh, const Triangle& t) {
  return has_distinct_corners(t) && has_valid_corners(mesh.positions, t);
}

float longest_edge(const PointSet& mesh, const Triangle& t) {
  const Vec3f &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
  return std::max({norm(b - a), norm(c - b), norm(a - c)});
}

/// Share of the edges without two triangles, one in each direction; 1 without edges.
double share_of_odd_edges(const PointSet& mesh) {
  // Stores each edge of each triangle under its lower end: the other end, and the direction in the lowest bit.
  std::vector<std::uint32_t> first(mesh.size() + 1, 0);
  const auto each_edge = [&](const auto& visit) {
    for (const Triangle& t : mesh.triangles)
      if (is_triangle(mesh, t))
        for (std::size_t k = 0; k < 3; ++k) visit(t[k], t[(k + 1) % 3]);
  };
  each_edge([&](std::uint32_t a, std::uint32_t b) { ++first[std::min(a, b) + 1]; });
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<std::uint64_t> ends(first.back());
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  each_edge([&](std::uint32_t a, std::uint32_t b) {
    ends[next[std::min(a, b)]++] = 2 * std::uint64_t{std::max(a, b)} + (a < b ? 0 : 1);
  });
  std::size_t edges = 0, odd = 0;
  for (std::size_t v = 0; v < mesh.size(); ++v) {
    const auto begin = ends.begin() + first[v], end = ends.begin() + first[v + 1];
    std::sort(begin, end);
    for (auto at = begin; at != end;) {
      const auto from = at;
      while (at != end && *at / 2 == *from / 2) ++at;
      ++edges;
      odd += !(at - from == 2 && from[0] % 2 == 0 && from[1] % 2 == 1);
    }
  }
  return edges > 0 ? static_cast<double>(odd) / static_cast<double>(edges) : 1;
}

struct Part {
  double volume = 0;
  Box3f box;
};

std::vector<Part> find_parts(const PointSet& mesh) {
  UnionFind sets(mesh.size());
  Box3f all;
  for (const Triangle& t : mesh.triangles) {
    if (!is_triangle(mesh, t)) continue;
    sets.join(t[0], t[1]), sets.join(t[0], t[2]);
    for (const std::uint32_t v : t) all.extend(mesh.positions[v]);
  }
  const Vec3 middle(all.center());
  std::vector<std::uint32_t> of(mesh.size(), 0);
  std::vector<Part> parts;
  for (const Triangle& t : mesh.triangles) {
    if (!is_triangle(mesh, t)) continue;
    std::uint32_t& number = of[sets.find(t[0])];
    if (number == 0) parts.emplace_back(), number = static_cast<std::uint32_t>(parts.size());
    Part& part = parts[number - 1];
    const Vec3 a(mesh.positions[t[0]]), b(mesh.positions[t[1]]), c(mesh.positions[t[2]]);
    part.volume += dot(a - middle, cross(b - middle, c - middle)) / 6;
    for (const std::uint32_t v : t) part.box.extend(mesh.positions[v]);
  }
  return parts;
}

bool holds(const Box3f& outer, const Box3f& inner) {
  for (std::size_t k = 0; k < 3; ++k)
    if (inner.lower[k] < outer.lower[k] || inner.upper[k] > outer.upper[k]) return false;
  return true;
}

/// Density of the vertices relative to the triangles.
struct Density {
  double area = 0;    ///< total area
  double sparse = 0;  ///< area of triangles with edges longer than `limit`
  double limit = 0;   ///< kLongEdge spacings of the vertices (length)
};

Density measure_density(const PointSet& mesh) {
  Density d;
  std::vector<double> area(mesh.triangles.size());
  for (std::size_t i = 0; i < area.size(); ++i)
    d.area += area[i] = 0.5 * norm(doubled_area(mesh.positions, mesh.triangles[i]));
  d.limit = kLongEdge * std::sqrt(d.area / static_cast<double>(mesh.size()));
  for (std::size_t i = 0; i < area.size(); ++i)
    if (area[i] > 0 && static_cast<double>(longest_edge(mesh, mesh.triangles[i])) > d.limit) d.sparse += area[i];
  return d;
}

bool is_dense(const PointSet& mesh, const Density& d) {
  return mesh.size() >= kEnoughVertices && d.sparse <= kSparseShare * d.area;
}

/// Edges of two triangles that differ by at least 30°.
std::vector<std::array<std::uint32_t, 2>> sharp_edges(const PointSet& mesh) {
  struct Side {
    std::uint32_t low, high, triangle;
  };
  std::vector<Side> sides;
  sides.reserve(3 * mesh.triangles.size());
  std::vector<Vec3f> normal(mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    if (!is_triangle(mesh, t)) continue;
    normal[i] = Vec3f(normalized(doubled_area(mesh.positions, t)));
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(t[k], t[(k + 1) % 3]);
      sides.push_back({low, high, static_cast<std::uint32_t>(i)});
    }
  }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
  });
  std::vector<std::array<std::uint32_t, 2>> sharp;
  for (std::size_t i = 0; i + 1 < sides.size(); ++i)
    if (sides[i].low == sides[i + 1].low && sides[i].high == sides[i + 1].high &&
        dot(normal[sides[i].triangle], normal[sides[i + 1].triangle]) < kCreaseCosine)
      sharp.push_back({sides[i].low, sides[i].high});
  return sharp;
}

/// Whether the mesh has creases, as of a machine part: many sharp edges, most of which continue straight at both ends.
/// The normals of its vertices are means over faces that differ. Sharp edges of scans are short pieces.
bool has_creases(const PointSet& mesh) {
  const auto sharp = sharp_edges(mesh);
  std::vector<std::array<std::uint32_t, 2>> beside(mesh.size());  // ends of the sharp edges of a vertex
  std::vector<std::uint8_t> count(mesh.size(), 0);
  for (const auto& e : sharp)
    for (std::size_t k = 0; k < 2; ++k) {
      std::uint8_t& n = count[e[k]];
      if (n < 2) beside[e[k]][n] = e[1 - k];
      if (n < 3) ++n;
    }
  std::size_t creased = 0, straight = 0;
  for (std::size_t v = 0; v < mesh.size(); ++v) {
    creased += count[v] > 0;
    if (count[v] != 2) continue;
    const Vec3f p = mesh.positions[v];
    straight += dot(normalized(mesh.positions[beside[v][0]] - p), normalized(mesh.positions[beside[v][1]] - p)) <
                kStraightCosine;
  }
  return static_cast<double>(creased) > kCreasedShare * static_cast<double>(mesh.size()) &&
         static_cast<double>(straight) > kStraightShare * static_cast<double>(creased);
}

}  // namespace

FaceSides face_sides(const PointSet& mesh) {
  if (mesh.triangles.empty() || share_of_odd_edges(mesh) > kOddEdges) return FaceSides::unknown;
  std::vector<Part> parts = find_parts(mesh);
  double total = 0;
  for (const Part& p : parts) total += p.volume;
  const bool inward = total < 0;
  if (inward)
    for (Part& p : parts) p.volume = -p.volume;
  std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.volume > b.volume; });
  std::size_t cavities = 0;
  for (std::size_t i = parts.size(); i > 0;) {
    --i;
    if (!(parts[i].volume < -kTinyPart * std::abs(total))) break;
    if (++cavities > kMostCavities) return FaceSides::unknown;
    bool inside = false;
    for (std::size_t k = 0; k < i && !inside && parts[k].volume > -parts[i].volume; ++k)
      inside = holds(parts[k].box, parts[i].box);
    if (!inside) return FaceSides::unknown;
  }
  return inward ? FaceSides::inward : FaceSides::outward;
}

ThinParts find_thin_parts(const PointSet& mesh, double longest) {
  const std::vector<FaceSample> probes = sample_triangles(mesh.positions, mesh.triangles, kProbes);
  if (probes.empty()) return {};
  const std::vector<Vec3f> normals = normals_from_faces(mesh);
  const KdTree vertices(mesh.positions);
  std::vector<float> depth(probes.size(), 0);  // 0: no opposite side
  parallel_for(0, probes.size(), 64, [&](std::size_t i) {
    const FaceSample& probe = probes[i];
    const Triangle& t = mesh.triangles[probe.triangle];
    const float edge = std::min(longest_edge(mesh, t), static_cast<float>(longest));
    // Faces oriented against their neighbours, as in polygon soups, are not informative.
    if (!(dot(normals[t[0]] + normals[t[1]] + normals[t[2]], probe.normal) > kOwnSide)) return;
    const Vec3f p(probe.position);
    std::vector<Neighbour> near;
    vertices.within(p, std::sqrt(kDepth * kDepth + kBeside * kBeside) * edge, near);
    for (const Neighbour& v : near) {
      if (!(dot(normals[v.index], probe.normal) < kOtherSide)) continue;
      const float d = -dot(probe.normal, mesh.positions[v.index] - p);
      if (!(d > 0 && d < kDepth * edge) || v.squared_distance - d * d > kBeside * kBeside * edge * edge) continue;
      if (depth[i] == 0 || d < depth[i]) depth[i] = d;
    }
  });
  std::vector<float> thin;
  for (const float d : depth)
    if (d > 0) thin.push_back(d);
  const double share = static_cast<double>(thin.size()) / static_cast<double>(probes.size());
  return {share, static_cast<double>(median(thin))};
}

bool faces_are_closed(const PointSet& mesh) { return share_of_odd_edges(mesh) == 0; }

bool vertices_are_dense(const PointSet& mesh) { return is_dense(mesh, measure_density(mesh)); }

std::size_t face_samples_wanted(const PointSet& mesh) {
  const Density density = measure_density(mesh);
  if (!is_dense(mesh, density)) return kFaceSamples;
  if (!(density.area > 0)) return 0;
  const ThinParts thin = find_thin_parts(mesh, density.limit);
  const bool closed = thin.share > kThinShareOfClosed && faces_are_closed(mesh);
  const auto n = static_cast<double>(mesh.size());
  const bool is_thin = thin.share > (closed ? kThinShareOfClosed : kThinShare), creased = has_creases(mesh);
  // The thin parts of a solid are joined by handles, however small their share.
  const double spacing = thin.thickness / (closed ? kAcrossClosed : kAcross * thin.share);
  double wanted = creased ? kOfCreasedVertex * n : 0;
  if (is_thin) wanted = creased ? kFaceSamples : kLeastOfVertex * n + density.area / (spacing * spacing);
  return index_in<std::size_t>(wanted, 0, std::max(kFaceSamples, kMostOfVertex * mesh.size()));
}

}  // namespace sansmesh::inline v1
