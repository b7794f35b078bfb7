#include "sansmesh/mesh/repair/cut_handles.h"

#include <algorithm>
#include <functional>
#include <queue>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "sansmesh/box.h"
#include "sansmesh/mesh/mesh_vertices.h"
#include "sansmesh/mesh/repair/components.h"
#include "sansmesh/mesh/repair/hole_patch.h"
#include "sansmesh/mesh/repair/self_intersections.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::uint32_t kNoHalf = HandleClasses::kNone;

/// The ring of triangles around a loop.
struct HandleBand {
  std::unordered_set<std::uint32_t> triangles;
  std::vector<std::vector<std::uint32_t>> borders;  ///< half-edges of the band along each border, in order
  std::size_t inner = 0;                            ///< number of vertices off the borders
};

/// Vertices within `width` of the loop along the edges.
std::unordered_set<std::uint32_t> near_loop(const TriangleMesh& mesh, const HandleClasses& classes,
                                            const HandleLoop& loop, double width) {
  std::unordered_map<std::uint32_t, double> distance;
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const std::uint32_t v : loop.vertices) distance[v] = 0, queue.emplace(0, v);
  const VertexCorners& corners = classes.corners();
  while (!queue.empty()) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (d > distance[v]) continue;
    for (std::uint32_t k = corners.first[v]; k < corners.first[v + 1]; ++k) {
      const std::uint32_t h = corners.entries[k];
      for (const std::uint32_t w : {classes.to(h), classes.from(HandleClasses::previous(h))}) {
        const double far = d + norm(Vec3(mesh.vertices[v]) - Vec3(mesh.vertices[w]));
        if (far > width) continue;
        const auto [at, fresh] = distance.try_emplace(w, far);
        if (!fresh && far >= at->second) continue;
        at->second = far;
        queue.emplace(far, w);
      }
    }
  }
  std::unordered_set<std::uint32_t> near;
  for (const auto& [v, d] : distance) near.insert(v);
  return near;
}

/// All triangles at the near vertices, if they form a ring inside the mesh whose borders have no common vertices.
std::optional<HandleBand> ring_around(const TriangleMesh& mesh, const HandleClasses& classes,
                                      const std::unordered_set<std::uint32_t>& near) {
  HandleBand band;
  std::unordered_set<std::uint32_t> vertices;
  const VertexCorners& corners = classes.corners();
  for (const std::uint32_t v : near)
    for (std::uint32_t k = corners.first[v]; k < corners.first[v + 1]; ++k)
      band.triangles.insert(corners.entries[k] / 3);
  std::size_t inner_halves = 0;
  std::unordered_map<std::uint32_t, std::uint32_t> leaving;
  for (const std::uint32_t t : band.triangles) {
    for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      vertices.insert(mesh.triangles[t][h % 3]);
      const std::uint32_t twin = classes.twin(h);
      if (twin == kNoHalf) return std::nullopt;
      if (band.triangles.contains(twin / 3))
        ++inner_halves;
      else if (!leaving.try_emplace(classes.from(h), h).second)
        return std::nullopt;
    }
  }
  const std::size_t edges = inner_halves / 2 + leaving.size();
  if (vertices.size() + band.triangles.size() != edges) return std::nullopt;
  band.inner = vertices.size() - leaving.size();
  // Starts of the borders in ascending order: the result does not depend on the order of the sets.
  std::vector<std::uint32_t> starts;
  starts.reserve(leaving.size());
  for (const auto& [v, h] : leaving) starts.push_back(v);
  std::sort(starts.begin(), starts.end());
  for (const std::uint32_t start : starts) {
    if (!leaving.contains(start)) continue;
    if (band.borders.size() == 2) return std::nullopt;
    band.borders.emplace_back();
    for (auto at = leaving.find(start); at != leaving.end();
         at = leaving.find(classes.to(band.borders.back().back()))) {
      band.borders.back().push_back(at->second);
      leaving.erase(at);
    }
  }
  if (band.borders.size() != 2) return std::nullopt;
  return band;
}

std::optional<HandleCap> cap_of(const TriangleMesh& mesh, const HandleClasses& classes, const HandleBand& band,
                                const std::vector<std::uint32_t>& border, std::size_t most) {
  HandleCap cap;
  const std::size_t n = border.size();
  std::vector<Vec3> x, beside, around;
  std::vector<double> scale(n, 0);
  std::unordered_map<std::uint32_t, std::uint32_t> number;
  const Vec3 base(mesh.vertices[classes.from(border[0])]);
  const auto relative = [&](std::uint32_t v) { return Vec3(mesh.vertices[v]) - base; };
  for (const std::uint32_t h : border) {
    number.emplace(classes.from(h), static_cast<std::uint32_t>(cap.rim.size()));
    cap.rim.push_back(classes.from(h));
    x.push_back(relative(classes.from(h)));
    beside.push_back(relative(classes.from(HandleClasses::previous(classes.twin(h)))));
  }
  const VertexCorners& corners = classes.corners();
  std::vector<detail::PatchTriangle> outside;
  std::unordered_set<std::uint64_t> joined_pairs;
  for (std::uint32_t i = 0; i < n; ++i) {
    double count = 0;
    for (std::uint32_t k = corners.first[cap.rim[i]]; k < corners.first[cap.rim[i] + 1]; ++k) {
      const std::uint32_t t = corners.entries[k] / 3;
      if (band.triangles.contains(t)) continue;
      std::size_t on_rim = 0;
      for (const std::uint32_t v : mesh.triangles[t]) {
        if (v == cap.rim[i]) continue;
        scale[i] += norm(relative(v) - x[i]), ++count;
        const auto at = number.find(v);
        if (at == number.end()) continue;
        ++on_rim;
        joined_pairs.insert(std::uint64_t{i} << 32 | at->second);
      }
      if (n == 3 && on_rim == 2) return std::nullopt;  // the cap exists as a triangle
      // Each triangle once, at its first corner of the rim.
      std::uint32_t first = i;
      for (const std::uint32_t v : mesh.triangles[t])
        if (const auto at = number.find(v); at != number.end()) first = std::min(first, at->second);
      if (first == i) outside.push_back({mesh.triangles[t][0], mesh.triangles[t][1], mesh.triangles[t][2]});
    }
    scale[i] /= std::max(count, 1.0);
  }
  const std::function<bool(std::uint32_t, std::uint32_t)> joined = [&](std::uint32_t a, std::uint32_t b) {
    return joined_pairs.contains(std::uint64_t{a} << 32 | b);
  };
  std::vector<detail::PatchTriangle> triangles = detail::triangulate_hole({x, beside, joined});
  if (triangles.empty()) return std::nullopt;
  detail::refine_patch(triangles, x, scale, n, most, joined);
  std::unordered_map<std::uint32_t, std::uint32_t> number_around;
  for (detail::PatchTriangle& t : outside)
    for (std::uint32_t& v : t) {
      if (const auto rim = number.find(v); rim != number.end()) {
        v = rim->second;
        continue;
      }
      const auto [at, fresh] = number_around.try_emplace(v, static_cast<std::uint32_t>(x.size() + around.size()));
      if (fresh) around.push_back(relative(v));
      v = at->second;
    }
  std::vector<Vec3> fair = x;
  bool good = true;
  for (int pass = 0; pass < 2 && good; ++pass) good = detail::fair_patch(triangles, outside, around, n, fair);
  double reach = 0;
  for (const Vec3& p : std::span(x).first(n)) reach = std::max(reach, norm(p));
  for (const Vec3& p : fair) good = good && norm(p) <= 2 * reach;
  if (good) x = std::move(fair);
  for (std::size_t i = n; i < x.size(); ++i) cap.fresh.push_back(base + x[i]);
  cap.triangles.assign(triangles.begin(), triangles.end());
  return cap;
}

}  // namespace

std::optional<HandleCut> cut_handle(const TriangleMesh& mesh, const HandleClasses& classes, const HandleLoop& loop,
                                    double width) {
  const std::optional<HandleBand> band = ring_around(mesh, classes, near_loop(mesh, classes, loop, width));
  if (!band) return std::nullopt;
  HandleCut cut;
  cut.band.assign(band->triangles.begin(), band->triangles.end());
  std::sort(cut.band.begin(), cut.band.end());
  for (std::size_t i = 0; i < 2; ++i) {
    std::optional<HandleCap> cap = cap_of(mesh, classes, *band, band->borders[i], band->inner / 2);
    if (!cap) return std::nullopt;
    cut.caps[i] = std::move(*cap);
  }
  return cut;
}

bool caps_intersect(const TriangleMesh& mesh, const HandleCut& cut, std::span<const std::uint32_t> around) {
  TriangleMesh part;
  std::unordered_map<std::uint32_t, std::uint32_t> number;
  const auto vertex = [&](std::uint32_t v) {
    const auto [at, fresh] = number.try_emplace(v, static_cast<std::uint32_t>(part.vertices.size()));
    if (fresh) part.vertices.push_back(mesh.vertices[v]);
    return at->second;
  };
  Box3f box;
  for (const HandleCap& cap : cut.caps) {
    std::vector<std::uint32_t> of;
    for (const std::uint32_t v : cap.rim) of.push_back(vertex(v)), box.extend(mesh.vertices[v]);
    for (const Vec3& p : cap.fresh) {
      of.push_back(static_cast<std::uint32_t>(part.vertices.size()));
      part.vertices.emplace_back(p);
      box.extend(part.vertices.back());
    }
    for (const Triangle& t : cap.triangles) part.triangles.push_back({of[t[0]], of[t[1]], of[t[2]]});
  }
  const std::size_t of_caps = part.triangles.size();
  for (const std::uint32_t t : around) {
    if (std::binary_search(cut.band.begin(), cut.band.end(), t)) continue;
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec3f &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    bool apart = false;
    for (std::size_t k = 0; k < 3; ++k)
      apart = apart || std::max({p[k], q[k], r[k]}) < box.lower[k] || std::min({p[k], q[k], r[k]}) > box.upper[k];
    if (!apart) part.triangles.push_back({vertex(a), vertex(b), vertex(c)});
  }
  for (const auto& [a, b] : self_intersections(part, 0))
    if (a < of_caps || b < of_caps) return true;
  return false;
}

void apply_cuts(TriangleMesh& mesh, std::span<const HandleCut> cuts) {
  std::vector<std::uint8_t> keep(mesh.triangles.size(), 1);
  for (const HandleCut& cut : cuts) {
    for (const std::uint32_t t : cut.band) keep[t] = 0;
    for (const HandleCap& cap : cut.caps) {
      std::vector<std::uint32_t> of = cap.rim;
      for (std::size_t i = 0; i < cap.fresh.size(); ++i) {
        of.push_back(append_vertex_copy(mesh, cap.rim[0]));
        mesh.vertices.back() = Vec3f(cap.fresh[i]);
      }
      std::vector<Vec3> normals(of.size());
      for (const Triangle& t : cap.triangles) {
        const Triangle corners{of[t[0]], of[t[1]], of[t[2]]};
        mesh.triangles.push_back(corners);
        const Vec3 a(mesh.vertices[corners[0]]), b(mesh.vertices[corners[1]]), c(mesh.vertices[corners[2]]);
        for (const std::uint32_t k : t) normals[k] += cross(b - a, c - a);
      }
      if (mesh.normals.empty()) continue;
      for (std::size_t i = cap.rim.size(); i < of.size(); ++i)
        if (squared_norm(normals[i]) > 0) mesh.normals[of[i]] = Vec3f(normalized(normals[i]));
    }
  }
  keep.resize(mesh.triangles.size(), 1);
  if (!cuts.empty()) keep_triangles(mesh, keep);
}

}  // namespace sansmesh::inline v1
