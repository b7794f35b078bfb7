#include "sansmesh/mesh/repair/fill_holes.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>

#include "sansmesh/box.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/error.h"
#include "sansmesh/mesh/mesh_vertices.h"
#include "sansmesh/mesh/repair/hole_patch.h"
#include "sansmesh/mesh/repair/place_edges.h"
#include "sansmesh/mesh/vertex_corners.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

using detail::PatchTriangle;

constexpr std::size_t kMostNewVertices = 200000;  // of one hole
/// So many vertices of the border give a new one its colour.
constexpr std::size_t kOfBorder = 6;
/// A filling that goes farther than this from the middle of its hole, in diameters, has not become fair.
constexpr double kFarthest = 1.5;
constexpr double kIslandOverDiameter = 0.25;
/// An end: steeper than this, and of at least this share of its piece and so many edges.
constexpr double kSteepEnd = 0.7, kLeastEnd = 0.02;
constexpr std::size_t kLeastEndEdges = 8;

/// An edge of one triangle, in the direction of a filling.
struct BorderEdge {
  std::uint32_t from, to;  ///< places
  std::uint32_t vertex;    ///< at `from`, of the border's triangle
  std::uint32_t beside;    ///< third place of that triangle
  std::uint32_t corner;    ///< as PlaceEdges has it
};

/// The mesh by places.
struct HoledMesh {
  const TriangleMesh& mesh;
  PlaceEdges edges;
  std::vector<std::uint32_t> piece;  ///< of each place: its first
  std::vector<Box3> box;             ///< of each piece

  explicit HoledMesh(const TriangleMesh& m)
      : mesh(m), edges(edges_by_place(m)), piece(m.vertices.size()), box(m.vertices.size()) {
    UnionFind sets(m.vertices.size());
    for (const PlaceEdges::Edge& e : edges.edges) sets.join(e.a, e.b);
    for (std::size_t v = 0; v < piece.size(); ++v)
      piece[v] = static_cast<std::uint32_t>(sets.find(static_cast<std::uint32_t>(v)));
    for (const PlaceEdges::Edge& e : edges.edges)
      for (const std::uint32_t v : {e.a, e.b}) box[piece[v]].extend(Vec3(m.vertices[v]));
  }

  bool joined(std::uint32_t a, std::uint32_t b) const {
    const std::uint32_t low = std::min(a, b), high = std::max(a, b);
    const auto at =
        std::lower_bound(edges.edges.begin(), edges.edges.end(), std::pair(low, high),
                         [](const PlaceEdges::Edge& e, const std::pair<std::uint32_t, std::uint32_t>& wanted) {
                           return e.a != wanted.first ? e.a < wanted.first : e.b < wanted.second;
                         });
    return at != edges.edges.end() && at->a == low && at->b == high;
  }
};

/// Of the directions into the mesh, across the edges of a loop, along the normal of the loop's plane.
double steepness_of(const HoledMesh& m, const std::vector<BorderEdge>& all, std::span<const std::uint32_t> path) {
  const auto place = [&](std::uint32_t p) { return Vec3(m.mesh.vertices[p]); };
  const Vec3 base = place(all[path[0]].from);
  Vec3 normal;
  for (const std::uint32_t i : path) normal += cross(place(all[i].from) - base, place(all[i].to) - base);
  if (!(squared_norm(normal) > 0)) return 0;
  normal = normalized(normal);
  double sum = 0, perimeter = 0;
  for (const std::uint32_t i : path) {
    const Vec3 a = place(all[i].from), edge = place(all[i].to) - a;
    const double length = norm(edge);
    if (!(length > 0)) continue;
    const Vec3 along = edge / length, to = place(all[i].beside) - a, inward = to - along * dot(to, along);
    perimeter += length;
    if (squared_norm(inward) > 0) sum += length * dot(normalized(inward), normal);
  }
  return perimeter > 0 ? std::abs(sum) / perimeter : 0;
}

HoleLoop measure_loop(const HoledMesh& m, const std::vector<BorderEdge>& all, std::span<const std::uint32_t> path) {
  HoleLoop loop;
  Box3 box;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const BorderEdge& e = all[path[i]];
    loop.vertices.push_back(e.vertex);
    const Vec3 a(m.mesh.vertices[e.from]), b(m.mesh.vertices[e.to]);
    const double length = norm(b - a);
    loop.perimeter += length;
    loop.middle += (a + b) * (length / 2);
    box.extend(a);
  }
  loop.middle =
      m.mesh.origin + (loop.perimeter > 0 ? loop.middle / loop.perimeter : Vec3(m.mesh.vertices[loop.vertices[0]]));
  loop.diameter = box.diagonal();
  const double whole = m.box[m.piece[all[path[0]].from]].diagonal();
  loop.share = whole > 0 ? loop.diameter / whole : 1;
  loop.steepness = steepness_of(m, all, path);
  return loop;
}

HoleLoops find_loops(const HoledMesh& m) {
  HoleLoops found;
  std::vector<BorderEdge> all;
  for (const PlaceEdges::Edge& e : m.edges.edges) {
    found.nonmanifold_edges += e.count > 2;
    if (e.count != 1) continue;
    const std::uint32_t corner = m.edges.corners[e.first];
    const Triangle& t = m.mesh.triangles[corner / 3];
    const std::uint32_t begin = t[corner % 3], end = t[(corner + 1 - corner / 3 * 3) % 3];
    const std::uint32_t beside = m.edges.place[t[(corner + 2 - corner / 3 * 3) % 3]];
    all.push_back({m.edges.place[end], m.edges.place[begin], end, beside, corner});
  }
  found.border_edges = all.size();
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> out;  // only looked up
  for (std::uint32_t i = 0; i < all.size(); ++i) out[all[i].from].push_back(i);
  std::vector<std::uint8_t> used(all.size(), 0);
  std::unordered_map<std::uint32_t, std::size_t> on_path;  // place → which edge of the path leaves it
  for (std::uint32_t first = 0; first < all.size(); ++first) {
    if (used[first]) continue;
    std::vector<std::uint32_t> path{first};
    used[first] = 1;
    on_path.clear();
    on_path[all[first].from] = 0;
    while (!path.empty()) {
      const std::uint32_t place = all[path.back()].to;
      if (const auto met = on_path.find(place); met != on_path.end()) {
        const std::size_t begin = met->second;
        const auto loop = std::span(path).subspan(begin);
        if (loop.size() >= 3)
          found.loops.push_back(measure_loop(m, all, loop));
        else
          found.stray_edges += loop.size();
        for (const std::uint32_t e : loop) on_path.erase(all[e].from);
        path.resize(begin);
        if (path.empty()) break;
        continue;
      }
      std::uint32_t next = kNoVertex;
      if (const auto leaving = out.find(place); leaving != out.end())
        for (const std::uint32_t e : leaving->second)
          if (!used[e]) {
            next = e;
            break;
          }
      if (next == kNoVertex) {
        ++found.stray_edges;
        on_path.erase(all[path.back()].from);
        path.pop_back();
        continue;
      }
      used[next] = 1;
      on_path[place] = path.size();
      path.push_back(next);
    }
  }
  std::stable_sort(found.loops.begin(), found.loops.end(),
                   [](const HoleLoop& a, const HoleLoop& b) { return a.diameter > b.diameter; });
  return found;
}

/// A filling, before it is part of the mesh.
struct HoleFilling {
  std::vector<PatchTriangle> triangles;
  std::vector<Vec3> x;  ///< loop first, relative to the loop's first vertex
  bool done = false;
};

using PlacePair = std::pair<std::uint32_t, std::uint32_t>;

HoleFilling fill_one(const HoledMesh& m, const VertexCorners& corners, const std::vector<double>& edge_length,
                     const HoleLoop& loop, const FillOptions& options, const std::set<PlacePair>& taken) {
  HoleFilling filling;
  const std::size_t n = loop.vertices.size();
  const Vec3 base(m.mesh.vertices[loop.vertices[0]]);
  std::vector<std::uint32_t> places(n);
  std::unordered_map<std::uint32_t, std::uint32_t> number;
  std::vector<double> scale(n);
  for (std::size_t i = 0; i < n; ++i) {
    places[i] = m.edges.place[loop.vertices[i]];
    number.emplace(places[i], static_cast<std::uint32_t>(i));
    filling.x.push_back(Vec3(m.mesh.vertices[places[i]]) - base);
    scale[i] = edge_length[places[i]];
  }
  // The triangles around, and of each edge of the loop the corner opposite.
  std::vector<PatchTriangle> outside;
  std::vector<Vec3> around, beside(n);
  std::set<std::uint32_t> seen;
  std::unordered_map<std::uint32_t, std::uint32_t> number_around;
  for (std::size_t i = 0; i < n; ++i)
    for (std::uint32_t c = corners.first[places[i]]; c < corners.first[places[i] + 1]; ++c) {
      const std::uint32_t triangle = corners.corner[c] / 3;
      Triangle t = m.mesh.triangles[triangle];
      if (!is_whole(m.mesh, t)) continue;
      for (std::uint32_t& v : t) v = m.edges.place[v];
      if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
      const std::uint32_t next = places[(i + 1) % n];
      for (std::size_t k = 0; k < 3; ++k)
        if (t[k] == next && t[(k + 1) % 3] == places[i]) beside[i] = Vec3(m.mesh.vertices[t[(k + 2) % 3]]) - base;
      if (!seen.insert(triangle).second) continue;
      outside.push_back(t);
    }
  const std::function<bool(std::uint32_t, std::uint32_t)> joined = [&](std::uint32_t a, std::uint32_t b) {
    const std::uint32_t p = places[a], q = places[b];
    return m.joined(p, q) || taken.contains({std::min(p, q), std::max(p, q)});
  };
  filling.triangles = detail::triangulate_hole({filling.x, beside, joined});
  if (filling.triangles.empty()) return filling;
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
  if (good) filling.x = std::move(fair);
  return filling;
}

/// The edges of a filling whose ends are both of the loop, but for the loop's own.
std::vector<PlacePair> chords_of(const HoledMesh& m, const HoleLoop& loop, const HoleFilling& filling) {
  const auto n = static_cast<std::uint32_t>(loop.vertices.size());
  std::vector<PlacePair> chords;
  for (const PatchTriangle& t : filling.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (a >= n || b >= n || (a + 1) % n == b || (b + 1) % n == a) continue;
      const std::uint32_t p = m.edges.place[loop.vertices[a]], q = m.edges.place[loop.vertices[b]];
      chords.emplace_back(std::min(p, q), std::max(p, q));
    }
  return chords;
}

/// New vertices with what belongs to them, by the nearest of the loop.
void append_filling(TriangleMesh& mesh, const HoleLoop& loop, const HoleFilling& filling,
                    std::vector<std::uint32_t>& number) {
  const std::size_t n = loop.vertices.size(), fresh = filling.x.size() - n, share = std::min(kOfBorder, n);
  const Vec3 base(mesh.vertices[loop.vertices[0]]);
  number = loop.vertices;
  if (fresh == 0) return;
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
}

/// Normals of the new vertices from their triangles.
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

/// Pieces whose middle lies near a filling.
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
    if (m.piece[m.edges.place[loop.vertices[0]]] == p) continue;
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
                           .from_data = "a fifth of the diagonal of the piece that they are in, and no ends: openings "
                                        "that the surface runs into steeply",
                           .range = positive()}),
      option<&O::edges>({.text = "Fill holes of at most so many edges", .range = {3, 2'000'000'000}}),
      option<&O::share>({.text = "Without `largest` and `edges`: fill holes of at most this share of their piece",
                         .unit = "share",
                         .range = {0, 1}}),
      option<&O::all>({.text = "Fill all, outer borders of open surfaces too"}),
      option<&O::refine>({.text = "Make the triangles as small as those around the hole"}),
      option<&O::fair>({.text = "Fill with the smallest surface instead of one that goes on smoothly",
                        .negative = "smallest_surface",
                        .old_name = "flat"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

void FillOptions::validate() const {
  validate_options(*this);
  if (all && (largest || edges)) throw ArgumentError("`all` means every hole, whatever `largest` or `edges` it has");
}

HoleLoops find_holes(const TriangleMesh& mesh) { return find_loops(HoledMesh(mesh)); }

FillReport fill_holes(TriangleMesh& mesh, const FillOptions& options, Progress& progress) {
  options.validate();
  progress.begin("find holes");
  FillReport report;
  const TriangleMesh before = mesh;
  const HoledMesh m(before);
  report.found = find_loops(m);
  const std::vector<HoleLoop>& loops = report.found.loops;
  std::vector<Triangle> by_place = before.triangles;
  for (Triangle& t : by_place)
    t = is_whole(before, t) ? Triangle{m.edges.place[t[0]], m.edges.place[t[1]], m.edges.place[t[2]]}
                            : Triangle{0, 0, 0};
  const VertexCorners corners(by_place, before.vertices.size());
  std::vector<double> edge_length(before.vertices.size()), count(before.vertices.size());
  for (const PlaceEdges::Edge& e : m.edges.edges)
    for (const std::uint32_t v : {e.a, e.b}) {
      edge_length[v] += norm(Vec3(before.vertices[e.a]) - Vec3(before.vertices[e.b]));
      count[v] += 1;
    }
  for (std::size_t v = 0; v < count.size(); ++v) edge_length[v] /= std::max(count[v], 1.0);

  const auto is_end = [&](const HoleLoop& loop) {
    return !options.all && !options.largest && !options.edges && loop.share <= options.share &&
           loop.share >= kLeastEnd && loop.steepness > kSteepEnd && loop.vertices.size() >= kLeastEndEdges;
  };
  const auto wanted = [&](const HoleLoop& loop) {
    if (options.all) return true;
    if (!options.largest && !options.edges) return loop.share <= options.share && !is_end(loop);
    return (!options.largest || loop.diameter <= *options.largest) &&
           (!options.edges || loop.vertices.size() <= *options.edges);
  };
  progress.begin("fill", loops.size());
  std::vector<HoleFilling> fillings(loops.size());
  parallel_for(0, loops.size(), 1, [&](std::size_t i) {
    if (wanted(loops[i])) fillings[i] = fill_one(m, corners, edge_length, loops[i], options, {});
    progress.advance();
  });
  std::set<PlacePair> taken;
  std::vector<Vec3f> filled;
  std::vector<std::uint32_t> hole_of;
  for (std::size_t i = 0; i < loops.size(); ++i) {
    std::optional<HoleOutcome>& outcome = report.found.loops[i].outcome;
    outcome = HoleOutcome::too_large;
    if (!wanted(loops[i])) {
      if (is_end(loops[i])) {
        outcome = HoleOutcome::end;
        ++report.ends;
      } else {
        ++report.too_large;
      }
      continue;
    }
    std::vector<PlacePair> chords = chords_of(m, loops[i], fillings[i]);
    if (std::any_of(chords.begin(), chords.end(), [&](const PlacePair& c) { return taken.contains(c); })) {
      fillings[i] = fill_one(m, corners, edge_length, loops[i], options, taken);  // beside one that it touches
      chords = chords_of(m, loops[i], fillings[i]);
    }
    if (!fillings[i].done) {
      outcome = HoleOutcome::failed;
      ++report.failed;
      continue;
    }
    taken.insert(chords.begin(), chords.end());
    outcome = HoleOutcome::filled;
    ++report.filled;
    std::vector<std::uint32_t> number;
    append_filling(mesh, loops[i], fillings[i], number);
    const Vec3 base(before.vertices[loops[i].vertices[0]]);
    for (const Vec3& p : fillings[i].x) filled.emplace_back(base + p), hole_of.push_back(static_cast<std::uint32_t>(i));
    for (const PatchTriangle& t : fillings[i].triangles) {
      mesh.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
      const Vec3 &a = fillings[i].x[t[0]], &b = fillings[i].x[t[1]], &c = fillings[i].x[t[2]];
      report.area += norm(cross(b - a, c - a)) / 2;
    }
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

constexpr ReportRow kHoleLoopRows[] = {
    reported<[](const HoleLoop& r) { return r.vertices.size(); }>(
        {.name = "edges", .text = "Edges of the border around it"}),
    reported<&HoleLoop::diameter>({.text = "Diagonal of its box", .unit = "length"}),
    reported<&HoleLoop::perimeter>({.text = "Length of its border", .unit = "length"}),
    reported<&HoleLoop::middle>({.name = "at", .text = "Middle of its border", .unit = "length"}),
    reported<&HoleLoop::share>(
        {.name = "share_of_piece", .text = "Its diameter over that of the piece that it is in", .unit = "share"}),
    reported<&HoleLoop::steepness>({.text = "How steeply the mesh leaves its plane: 1 of a tube", .unit = "share"}),
    reported<&HoleLoop::outcome>({.text = "Result of filling it", .choices = kOutcomeWords})};

}  // namespace

const ReportSchema& HoleLoop::schema() {
  static constexpr ReportSchema schema{kHoleLoopRows};
  return schema;
}

namespace {

constexpr ReportRow kHoleLoopsRows[] = {
    reported<&HoleLoops::border_edges>({.text = "Edges of one triangle"}),
    reported<&HoleLoops::stray_edges>({.name = "stray_border_edges", .text = "Edges of these that run around no hole"}),
    reported<&HoleLoops::nonmanifold_edges>({.text = "Edges of three triangles or more"}),
    reported<&HoleLoops::loops>({.name = "holes", .text = "Holes, the largest first"})};

}  // namespace

const ReportSchema& HoleLoops::schema() {
  static constexpr ReportSchema schema{kHoleLoopsRows};
  return schema;
}

namespace {

constexpr ReportRow kFillReportRows[] = {
    reported_beside<&FillReport::found>(),
    reported<&FillReport::filled>({.text = "Holes that were filled"}),
    reported<&FillReport::too_large>({.name = "left_open", .text = "Holes that were left open for their size"}),
    reported<&FillReport::ends>({.text = "Holes that were left open as ends of a tube"}),
    reported<&FillReport::failed>({.text = "Holes that no triangles go across"}),
    reported<&FillReport::islands>({.text = "Separate pieces that lie in fillings"}),
    reported<&FillReport::vertices>({.name = "added.vertices", .text = "Vertices that were added"}),
    reported<&FillReport::triangles>({.name = "added.triangles", .text = "Triangles that were added"}),
    reported<&FillReport::area>({.name = "added.area", .text = "Area that was added", .unit = "length²"})};

}  // namespace

const ReportSchema& FillReport::schema() {
  static constexpr ReportSchema schema{kFillReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
