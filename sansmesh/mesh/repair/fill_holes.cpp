#include "sansmesh/mesh/repair/fill_holes.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_map>
#include <utility>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/data/triangles.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/repair/hole_loops.h"
#include "sansmesh/mesh/repair/hole_patch.h"
#include "sansmesh/mesh/repair/position_edges.h"
#include "sansmesh/mesh/repair/self_intersections.h"
#include "sansmesh/mesh/vertex_corners.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

using detail::HoledMesh, detail::PatchTriangle;

constexpr std::size_t kMostNewVertices = 200000;  // per hole
/// Number of border vertices that determine the colour of a new one.
constexpr std::size_t kOfBorder = 6;
/// Largest distance of a fair filling from the centre of its hole, in diameters.
constexpr double kFarthest = 1.5;
constexpr double kIslandOverDiameter = 0.25;
constexpr double kCrossing = 1e-6;  // tolerance of intersections, in diameters
/// Open ends: least steepness, least share of the component and least number of edges.
constexpr double kSteepEnd = 0.7, kLeastEnd = 0.02;
constexpr std::size_t kLeastEndEdges = 8;

/// Mean length of the edges at each representative.
std::vector<double> mean_edge_lengths(const HoledMesh& m) {
  std::vector<double> length(m.mesh.vertices.size()), count(length);
  for (const PositionEdges::Edge& e : m.edges.edges)
    for (const std::uint32_t v : {e.a, e.b}) {
      length[v] += norm(Vec3(m.mesh.vertices[e.a]) - Vec3(m.mesh.vertices[e.b]));
      count[v] += 1;
    }
  for (std::size_t v = 0; v < count.size(); ++v) length[v] /= std::max(count[v], 1.0);
  return length;
}

/// Whether the options require filling a hole (`filled`), or why not.
HoleOutcome choice_for(const HoleLoop& loop, const FillOptions& options) {
  if (options.all) return HoleOutcome::filled;
  if (options.largest || options.edges)
    return (!options.largest || loop.diameter <= *options.largest) &&
                   (!options.edges || loop.vertices.size() <= *options.edges)
               ? HoleOutcome::filled
               : HoleOutcome::too_large;
  if (!(loop.share <= options.share)) return HoleOutcome::too_large;
  const bool is_end = loop.share >= kLeastEnd && loop.steepness > kSteepEnd && loop.vertices.size() >= kLeastEndEdges;
  return is_end ? HoleOutcome::end : HoleOutcome::filled;
}

/// Filling that is not yet part of the mesh.
struct HoleFilling {
  std::vector<PatchTriangle> triangles;
  std::vector<Vec3> x;  ///< positions, loop first, relative to the loop's first vertex
  bool done = false;
};

/// Number of intersections of a filling with itself and with the triangles around it.
std::size_t crossings_of(const std::vector<PatchTriangle>& triangles, const std::vector<PatchTriangle>& outside,
                         const std::vector<Vec3>& x, const std::vector<Vec3>& around, double tolerance) {
  TriangleMesh mesh;
  for (const auto* const list : {&x, &around})
    for (const Vec3& p : *list) mesh.vertices.emplace_back(p);
  mesh.triangles = triangles;
  mesh.triangles.insert(mesh.triangles.end(), outside.begin(), outside.end());
  return count_self_intersections(mesh, tolerance, [](std::uint32_t, std::uint32_t) {});
}

using PositionPair = std::pair<std::uint32_t, std::uint32_t>;

HoleFilling fill_one(const HoledMesh& m, const VertexCorners& corners, const std::vector<double>& edge_length,
                     const HoleLoop& loop, const FillOptions& options, const std::set<PositionPair>& taken) {
  HoleFilling filling;
  const std::size_t n = loop.vertices.size();
  const Vec3 base(m.mesh.vertices[loop.vertices[0]]);
  std::vector<std::uint32_t> ring(n);
  std::unordered_map<std::uint32_t, std::uint32_t> number;
  std::vector<double> scale(n);
  for (std::size_t i = 0; i < n; ++i) {
    ring[i] = m.edges.representative[loop.vertices[i]];
    number.emplace(ring[i], static_cast<std::uint32_t>(i));
    filling.x.push_back(Vec3(m.mesh.vertices[ring[i]]) - base);
    scale[i] = edge_length[ring[i]];
  }
  // Surrounding triangles, and the corner opposite each edge of the loop.
  std::vector<PatchTriangle> outside;
  std::vector<Vec3> around, beside(n);
  std::set<std::uint32_t> seen;
  std::unordered_map<std::uint32_t, std::uint32_t> number_around;
  for (std::size_t i = 0; i < n; ++i)
    for (std::uint32_t c = corners.first[ring[i]]; c < corners.first[ring[i] + 1]; ++c) {
      const std::uint32_t triangle = corners.entries[c] / 3;
      Triangle t = m.mesh.triangles[triangle];
      if (!has_valid_corners(m.mesh.vertices, t)) continue;
      for (std::uint32_t& v : t) v = m.edges.representative[v];
      if (!has_distinct_corners(t)) continue;
      const std::uint32_t next = ring[(i + 1) % n];
      for (std::size_t k = 0; k < 3; ++k)
        if (t[k] == next && t[(k + 1) % 3] == ring[i]) beside[i] = Vec3(m.mesh.vertices[t[(k + 2) % 3]]) - base;
      if (!seen.insert(triangle).second) continue;
      outside.push_back(t);
    }
  const std::function<bool(std::uint32_t, std::uint32_t)> joined = [&](std::uint32_t a, std::uint32_t b) {
    const std::uint32_t p = ring[a], q = ring[b];
    return m.joined(p, q) || taken.contains({std::min(p, q), std::max(p, q)});
  };
  filling.triangles = detail::triangulate_hole({filling.x, beside, joined});
  if (filling.triangles.empty()) return filling;
  detail::split_existing_edges(filling.triangles, filling.x, scale, joined);
  filling.done = true;
  if (!options.refine) return filling;
  detail::refine_patch(filling.triangles, filling.x, scale, n, kMostNewVertices, joined);
  if (!options.fair || filling.x.size() == n) return filling;
  for (PatchTriangle& t : outside)
    for (std::uint32_t& v : t) {
      if (const auto rim = number.find(v); rim != number.end()) {
        v = rim->second;
        continue;
      }
      const auto [at, fresh] =
          number_around.try_emplace(v, static_cast<std::uint32_t>(filling.x.size() + around.size()));
      if (fresh) around.push_back(Vec3(m.mesh.vertices[v]) - base);
      v = at->second;
    }
  std::vector<Vec3> fair = filling.x;
  bool good = true;
  for (int pass = 0; pass < 2 && good; ++pass) good = detail::fair_patch(filling.triangles, outside, around, n, fair);
  const Vec3 middle = loop.middle - m.mesh.origin - base;
  for (const Vec3& p : fair) good = good && norm(p - middle) <= kFarthest * loop.diameter;
  const auto crossings = [&](const std::vector<Vec3>& x) {
    return crossings_of(filling.triangles, outside, x, around, kCrossing * loop.diameter);
  };
  if (good && (crossings(fair) == 0 || crossings(filling.x) > 0)) filling.x = std::move(fair);
  return filling;
}

/// Edges of a filling between two vertices of the loop, without the loop's edges.
std::vector<PositionPair> chords_of(const HoledMesh& m, const HoleLoop& loop, const HoleFilling& filling) {
  const auto n = static_cast<std::uint32_t>(loop.vertices.size());
  std::vector<PositionPair> chords;
  for (const PatchTriangle& t : filling.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (a >= n || b >= n || (a + 1) % n == b || (b + 1) % n == a) continue;
      const std::uint32_t p = m.edges.representative[loop.vertices[a]], q = m.edges.representative[loop.vertices[b]];
      chords.emplace_back(std::min(p, q), std::max(p, q));
    }
  return chords;
}

/// Appends new vertices, interpolated from the nearest vertices of the loop; returns the indices of all vertices.
std::vector<std::uint32_t> append_filling_vertices(TriangleMesh& mesh, const HoleLoop& loop,
                                                   const HoleFilling& filling) {
  const std::size_t n = loop.vertices.size(), fresh = filling.x.size() - n, share = std::min(kOfBorder, n);
  const Vec3 base(mesh.vertices[loop.vertices[0]]);
  std::vector<std::uint32_t> number = loop.vertices;
  if (fresh == 0) return number;
  const std::vector<Vec3f> rim(filling.x.begin(), filling.x.begin() + static_cast<std::ptrdiff_t>(n));
  const KdTree tree(rim);
  std::vector<std::uint32_t> rows;
  std::vector<double> weights;
  std::vector<Neighbour> near(share);
  for (std::size_t v = n; v < filling.x.size(); ++v) {
    tree.nearest(Vec3f(filling.x[v]), near);
    double sum = 0;
    for (const Neighbour& one : near) sum += 1 / std::max(static_cast<double>(one.squared_distance), 1e-30);
    for (const Neighbour& one : near) {
      rows.push_back(loop.vertices[one.index]);
      weights.push_back(1 / std::max(static_cast<double>(one.squared_distance), 1e-30) / sum);
    }
    number.push_back(static_cast<std::uint32_t>(mesh.vertices.size() + v - n));
  }
  for (std::size_t i = 0; i < fresh; ++i) {
    mesh.vertices.push_back(Vec3f(base + filling.x[n + i]));
    Vec3 normal, color;
    for (std::size_t k = i * share; k < (i + 1) * share; ++k) {
      if (!mesh.normals.empty()) normal += Vec3(mesh.normals[rows[k]]) * weights[k];
      if (!mesh.colors.empty()) {
        const auto& c = mesh.colors[rows[k]];
        color += Vec3(c[0], c[1], c[2]) * weights[k];
      }
    }
    if (!mesh.normals.empty()) mesh.normals.push_back(Vec3f(normalized(normal)));
    if (!mesh.colors.empty()) {
      const auto byte = [](double c) { return index_in<std::uint8_t>(std::round(c), 0, 255); };
      mesh.colors.push_back({byte(color.x), byte(color.y), byte(color.z)});
    }
  }
  if (!mesh.attributes.empty()) {
    const AttributeTable mixed = mesh.attributes.blended(share, rows, weights);
    std::vector<std::uint32_t> order(fresh);
    for (std::size_t i = 0; i < fresh; ++i) order[i] = static_cast<std::uint32_t>(i);
    mesh.attributes.append(mixed, order);
  }
  return number;
}

/// Appends a filling to a mesh, and its area to `area`.
void append_filling(TriangleMesh& mesh, const HoleLoop& loop, const HoleFilling& filling, double& area) {
  const std::vector<std::uint32_t> number = append_filling_vertices(mesh, loop, filling);
  for (const PatchTriangle& t : filling.triangles) {
    mesh.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
    const Vec3 &a = filling.x[t[0]], &b = filling.x[t[1]], &c = filling.x[t[2]];
    area += norm(cross(b - a, c - a)) / 2;
  }
}

/// Computes normals of the new vertices from their triangles.
void set_new_normals(TriangleMesh& mesh, std::size_t first_vertex, std::size_t first_triangle) {
  if (mesh.normals.empty()) return;
  std::vector<Vec3> sum(mesh.vertices.size() - first_vertex);
  for (std::size_t i = first_triangle; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    const Vec3 a(mesh.vertices[t[0]]), b(mesh.vertices[t[1]]), c(mesh.vertices[t[2]]);
    for (const std::uint32_t v : t)
      if (v >= first_vertex) sum[v - first_vertex] += cross(b - a, c - a);
  }
  for (std::size_t v = 0; v < sum.size(); ++v)
    if (squared_norm(sum[v]) > 0) mesh.normals[first_vertex + v] = Vec3f(normalized(sum[v]));
}

/// Counts components whose centre is near a filling.
std::size_t count_islands(const HoledMesh& m, const std::vector<Vec3f>& filled,
                          const std::vector<std::uint32_t>& hole_of, const HoleLoops& found) {
  if (filled.empty()) return 0;
  const KdTree tree(filled);
  std::size_t count = 0;
  for (std::uint32_t p = 0; p < m.box.size(); ++p) {
    if (m.piece[p] != p || m.box[p].empty()) continue;
    const auto near = tree.nearest(Vec3f(m.box[p].center()));
    if (!near) continue;
    const HoleLoop& loop = found.loops[hole_of[near->index]];
    if (m.piece[m.edges.representative[loop.vertices[0]]] == p) continue;
    count += std::sqrt(static_cast<double>(near->squared_distance)) < kIslandOverDiameter * loop.diameter;
  }
  return count;
}

}  // namespace

const OptionSchema& FillOptions::schema() {
  using O = FillOptions;
  static constexpr OptionRow rows[] = {
      option<&O::largest>({.text = "Fill holes of at most this diameter",
                           .unit = "length",
                           .from_data = "a fifth of the diagonal of their component, except ends: openings "
                                        "with steep surroundings",
                           .range = positive()}),
      option<&O::edges>({.text = "Fill holes of at most this number of edges", .range = {3, 2'000'000'000}}),
      option<&O::share>({.text = "Without `largest` and `edges`: fill holes of at most this share of their component",
                         .unit = "share",
                         .range = {0, 1}}),
      option<&O::all>({.text = "Fill all, including outer borders of open surfaces"}),
      option<&O::refine>({.text = "Refine to the triangle size around the hole"}),
      option<&O::fair>({.text = "Fill with the surface of least area instead of a smooth continuation",
                        .negative = "smallest_surface",
                        .old_name = "flat"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

void FillOptions::validate() const {
  validate_options(*this);
  if (all && (largest || edges)) throw ArgumentError("`all` fills every hole: it conflicts with `largest` and `edges`");
}

HoleLoops find_holes(const TriangleMesh& mesh) { return detail::find_loops(HoledMesh(mesh)); }

FillReport fill_holes(TriangleMesh& mesh, const FillOptions& options, Progress& progress) {
  options.validate();
  progress.begin("find holes");
  FillReport report;
  const TriangleMesh before = mesh;
  const HoledMesh m(before);
  report.found = detail::find_loops(m);
  const std::vector<HoleLoop>& loops = report.found.loops;
  std::vector<Triangle> by_position = before.triangles;
  for (Triangle& t : by_position)
    t = has_valid_corners(before.vertices, t)
            ? Triangle{m.edges.representative[t[0]], m.edges.representative[t[1]], m.edges.representative[t[2]]}
            : Triangle{0, 0, 0};
  const VertexCorners corners(by_position, before.vertices.size());
  const std::vector<double> edge_length = mean_edge_lengths(m);
  progress.begin("fill", loops.size());
  std::vector<HoleFilling> fillings(loops.size());
  parallel_for(0, loops.size(), 1, [&](std::size_t i) {
    if (choice_for(loops[i], options) == HoleOutcome::filled)
      fillings[i] = fill_one(m, corners, edge_length, loops[i], options, {});
    progress.advance();
  });
  std::set<PositionPair> taken;
  std::vector<Vec3f> filled;
  std::vector<std::uint32_t> hole_of;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    HoleOutcome outcome = choice_for(loops[i], options);
    if (outcome == HoleOutcome::filled) {
      std::vector<PositionPair> chords = chords_of(m, loops[i], fillings[i]);
      if (std::any_of(chords.begin(), chords.end(), [&](const PositionPair& c) { return taken.contains(c); })) {
        fillings[i] = fill_one(m, corners, edge_length, loops[i], options, taken);  // conflicts with a touching hole
        chords = chords_of(m, loops[i], fillings[i]);
      }
      if (fillings[i].done) {
        taken.insert(chords.begin(), chords.end());
        append_filling(mesh, loops[i], fillings[i], report.area);
        const Vec3 base(before.vertices[loops[i].vertices[0]]);
        for (const Vec3& p : fillings[i].x) filled.emplace_back(base + p);
        hole_of.resize(filled.size(), static_cast<std::uint32_t>(i));
      } else {
        outcome = HoleOutcome::failed;
      }
    }
    report.found.loops[i].outcome = outcome;
    ++(outcome == HoleOutcome::filled      ? report.filled
       : outcome == HoleOutcome::too_large ? report.too_large
       : outcome == HoleOutcome::failed    ? report.failed
                                           : report.ends);
  }
  report.triangles = mesh.triangles.size() - before.triangles.size();
  report.vertices = mesh.vertices.size() - before.vertices.size();
  set_new_normals(mesh, before.vertices.size(), before.triangles.size());
  if (!mesh.triangle_attributes.empty()) {
    const AttributeTable known = mesh.triangle_attributes, none;
    const AttributeTable* const tables[] = {&known, &none};
    const std::size_t rows[] = {before.triangles.size(), report.triangles};
    mesh.triangle_attributes = join_rows(tables, rows);
  }
  report.islands = count_islands(m, filled, hole_of, report.found);
  progress.finish();
  return report;
}

namespace {

constexpr ReportRow kFillReportRows[] = {
    reported_inline<&FillReport::found>(),
    reported<&FillReport::filled>({.text = "Filled holes"}),
    reported<&FillReport::too_large>({.name = "left_open", .text = "Holes left open because of their size"}),
    reported<&FillReport::ends>({.text = "Holes left open as ends of a tube"}),
    reported<&FillReport::failed>({.text = "Holes without a valid triangulation"}),
    reported<&FillReport::islands>({.text = "Separate components inside fillings"}),
    reported<&FillReport::vertices>({.name = "added.vertices", .text = "Added vertices"}),
    reported<&FillReport::triangles>({.name = "added.triangles", .text = "Added triangles"}),
    reported<&FillReport::area>({.name = "added.area", .text = "Added area", .unit = "length²"})};

}  // namespace

const ReportSchema& FillReport::schema() {
  static constexpr ReportSchema schema{kFillReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
