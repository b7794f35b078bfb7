#include "sansmesh/mesh/repair/hole_loops.h"

#include <cmath>
#include <span>
#include <unordered_map>

#include "sansmesh/core/union_find.h"
#include "sansmesh/mesh/mesh_vertices.h"

namespace sansmesh::inline v1 {
namespace {

using detail::HoledMesh;

/// Edge of one triangle, in the direction of a filling.
struct BorderEdge {
  std::uint32_t from, to;  ///< representatives
  std::uint32_t vertex;    ///< vertex of the border triangle at `from`
  std::uint32_t beside;    ///< third corner of that triangle (representative)
  std::uint32_t corner;    ///< as in PositionEdges
};

/// Mean component, along the normal of the loop's plane, of the directions from the edges of a loop into the mesh.
double steepness_of(const HoledMesh& m, const std::vector<BorderEdge>& all, std::span<const std::uint32_t> path) {
  const auto point = [&](std::uint32_t p) { return Vec3(m.mesh.vertices[p]); };
  const Vec3 base = point(all[path[0]].from);
  Vec3 normal;
  for (const std::uint32_t i : path) normal += cross(point(all[i].from) - base, point(all[i].to) - base);
  if (!(squared_norm(normal) > 0)) return 0;
  normal = normalized(normal);
  double sum = 0, perimeter = 0;
  for (const std::uint32_t i : path) {
    const Vec3 a = point(all[i].from), edge = point(all[i].to) - a;
    const double length = norm(edge);
    if (!(length > 0)) continue;
    const Vec3 along = edge / length, to = point(all[i].beside) - a, inward = to - along * dot(to, along);
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

}  // namespace

detail::HoledMesh::HoledMesh(const TriangleMesh& m)
    : mesh(m), edges(edges_by_position(m)), piece(m.vertices.size()), box(m.vertices.size()) {
  UnionFind sets(m.vertices.size());
  for (const PositionEdges::Edge& e : edges.edges) sets.join(e.a, e.b);
  for (std::uint32_t v = 0; v < piece.size(); ++v) piece[v] = sets.find(v);
  for (const PositionEdges::Edge& e : edges.edges)
    for (const std::uint32_t v : {e.a, e.b}) box[piece[v]].extend(Vec3(m.vertices[v]));
}

bool detail::HoledMesh::joined(std::uint32_t a, std::uint32_t b) const {
  const std::pair<std::uint32_t, std::uint32_t> wanted = std::minmax(a, b);
  const auto at = std::lower_bound(edges.edges.begin(), edges.edges.end(), wanted,
                                   [](const PositionEdges::Edge& e, const auto& w) { return std::pair(e.a, e.b) < w; });
  return at != edges.edges.end() && std::pair(at->a, at->b) == wanted;
}

HoleLoops detail::find_loops(const HoledMesh& m) {
  HoleLoops found;
  std::vector<BorderEdge> all;
  for (const PositionEdges::Edge& e : m.edges.edges) {
    found.nonmanifold_edges += e.count > 2;
    if (e.count != 1) continue;
    const std::uint32_t corner = m.edges.corners[e.first];
    const Triangle& t = m.mesh.triangles[corner / 3];
    const std::uint32_t begin = t[corner % 3], end = t[(corner + 1) % 3];
    const std::uint32_t beside = m.edges.representative[t[(corner + 2) % 3]];
    all.push_back({m.edges.representative[end], m.edges.representative[begin], end, beside, corner});
  }
  found.border_edges = all.size();
  std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> out;  // for lookup only
  for (std::uint32_t i = 0; i < all.size(); ++i) out[all[i].from].push_back(i);
  std::vector<std::uint8_t> used(all.size(), 0);
  std::unordered_map<std::uint32_t, std::size_t>
      on_path;  // representative → index of the edge of the path that starts there
  for (std::uint32_t first = 0; first < all.size(); ++first) {
    if (used[first]) continue;
    std::vector<std::uint32_t> path{first};
    used[first] = 1;
    on_path.clear();
    on_path[all[first].from] = 0;
    while (!path.empty()) {
      const std::uint32_t end = all[path.back()].to;
      if (const auto met = on_path.find(end); met != on_path.end()) {
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
      if (const auto leaving = out.find(end); leaving != out.end())
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
      on_path[end] = path.size();
      path.push_back(next);
    }
  }
  std::stable_sort(found.loops.begin(), found.loops.end(),
                   [](const HoleLoop& a, const HoleLoop& b) { return a.diameter > b.diameter; });
  return found;
}

namespace {

constexpr ReportRow kHoleLoopRows[] = {
    reported<[](const HoleLoop& r) { return r.vertices.size(); }>(
        {.name = "edges", .text = "Edges of the border around it"}),
    reported<&HoleLoop::diameter>({.text = "Diagonal of its box", .unit = "length"}),
    reported<&HoleLoop::perimeter>({.text = "Length of its border", .unit = "length"}),
    reported<&HoleLoop::middle>({.name = "at", .text = "Middle of its border", .unit = "length"}),
    reported<&HoleLoop::share>(
        {.name = "share_of_piece", .text = "Its diameter over that of its component", .unit = "share"}),
    reported<&HoleLoop::steepness>({.text = "Steepness of the mesh against its plane: 1 for a tube", .unit = "share"}),
    reported<&HoleLoop::outcome>({.text = "Result of filling it", .choices = kOutcomeWords})};

}  // namespace

const ReportSchema& HoleLoop::schema() {
  static constexpr ReportSchema schema{kHoleLoopRows};
  return schema;
}

namespace {

constexpr ReportRow kHoleLoopsRows[] = {
    reported<&HoleLoops::border_edges>({.text = "Edges of one triangle"}),
    reported<&HoleLoops::stray_edges>({.name = "stray_border_edges", .text = "Border edges that surround no hole"}),
    reported<&HoleLoops::nonmanifold_edges>({.text = "Edges of three triangles or more"}),
    reported<&HoleLoops::loops>({.name = "holes", .text = "Holes, the largest first"})};

}  // namespace

const ReportSchema& HoleLoops::schema() {
  static constexpr ReportSchema schema{kHoleLoopsRows};
  return schema;
}

}  // namespace sansmesh::inline v1
