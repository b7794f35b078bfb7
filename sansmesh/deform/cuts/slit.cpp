#include "sansmesh/deform/cuts/slit.h"

#include <algorithm>
#include <map>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "sansmesh/core/edge_key.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/data/triangles.h"
#include "sansmesh/mesh/edit/deformed_mesh.h"
#include "sansmesh/mesh/edit/refine_edges.h"
#include "sansmesh/mesh/mesh_vertices.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kSnap = 1e-3;        // fraction of an edge: vertices closer to the cut are on it
constexpr double kMostRounded = 0.5;  // largest rounding error over the distance to the triangles' centroids
constexpr int kSnapRounds = 4;
constexpr std::size_t kEdgesAtATime = 1024;

class SlitMaker {
 public:
  SlitMaker(TriangleMesh& mesh, std::span<const std::shared_ptr<const Occluder>> cuts)
      : mesh_(mesh), cuts_(cuts), cut_(*cuts.back()) {}

  Slit make(int refinements) {
    for (int round = 0;; ++round) {
      find_crossings();
      for (int i = 0; i < kSnapRounds && snap(); ++i) find_crossings();
      find_tips();
      const bool last = round == refinements;
      look_at_triangles(last);
      if (bad_.empty() || last) break;
      std::unordered_set<std::uint64_t> split;
      for (const std::size_t t : bad_)
        for (std::size_t k = 0; k < 3; ++k)
          split.insert(edge_key(mesh_.triangles[t][k], mesh_.triangles[t][(k + 1) % 3]));
      split_edges(mesh_, [&](std::uint32_t a, std::uint32_t b) { return split.count(edge_key(a, b)) != 0; });
    }
    Slit slit;
    slit.unopened = bad_.size();
    if (cut_edges_.empty() && cut_points_.empty() && tips_.empty()) return slit;
    split_triangles();
    if (!cut_edges_.empty()) part(slit);
    return slit;
  }

 private:
  struct CutPoint {  // on an edge, as a fraction from its smaller vertex
    double share;
  };
  enum class Way : std::uint8_t { none, across, ending, along };
  struct Look {
    Way way = Way::none;
    Vec3 tip;
  };

  Vec3 world(std::uint32_t v) const { return mesh_.origin + Vec3(mesh_.vertices[v]); }
  bool good(const Triangle& t) const { return has_valid_corners(mesh_.vertices, t) && has_distinct_corners(t); }

  /// Finds where the cut crosses edges, except at vertices that are on the cut.
  void find_crossings() {
    on_cut_.resize(mesh_.vertices.size());
    std::vector<std::uint64_t> edges;
    edges.reserve(3 * mesh_.triangles.size());
    for (const Triangle& t : mesh_.triangles)
      if (good(t))
        for (std::size_t k = 0; k < 3; ++k) edges.push_back(edge_key(t[k], t[(k + 1) % 3]));
    parallel_sort(edges);
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    std::vector<std::vector<double>> found((edges.size() + kEdgesAtATime - 1) / kEdgesAtATime);
    std::vector<std::vector<std::uint32_t>> counts(found.size());
    parallel_for(0, found.size(), 1, [&](std::size_t chunk) {
      const std::size_t first = chunk * kEdgesAtATime, end = std::min(edges.size(), first + kEdgesAtATime);
      for (std::size_t e = first; e < end; ++e) {
        const std::size_t before = found[chunk].size();
        cut_.crossings(world(smaller_end(edges[e])), world(larger_end(edges[e])), found[chunk]);
        counts[chunk].push_back(static_cast<std::uint32_t>(found[chunk].size() - before));
      }
    });
    all_.clear(), cut_points_.clear(), twice_.clear();
    for (std::size_t chunk = 0; chunk < found.size(); ++chunk) {
      std::size_t at = 0;
      for (std::size_t i = 0; i < counts[chunk].size(); ++i) {
        const std::uint64_t key = edges[chunk * kEdgesAtATime + i];
        int inner = 0;
        // Rounding creates false crossings on edges along the cut between two vertices on it.
        if (counts[chunk][i] > 0 && on_cut_[smaller_end(key)] && on_cut_[larger_end(key)] && lies_along(key)) {
          at += counts[chunk][i];
          continue;
        }
        for (std::uint32_t k = 0; k < counts[chunk][i]; ++k, ++at) {
          const double share = found[chunk][at];
          if (on_cut_[smaller_end(key)] && share < 2 * kSnap) continue;
          if (on_cut_[larger_end(key)] && share > 1 - 2 * kSnap) continue;
          all_.emplace_back(key, share);
          if (inner++ == 0) cut_points_[key] = {share};
        }
        if (inner > 1) twice_.insert(key);
      }
    }
  }

  /// Moves vertices that are almost on the cut onto it; returns whether there were any.
  bool snap() {
    struct Move {
      double length = 0;
      Vec3 to;
    };
    std::map<std::uint32_t, Move> moves;
    for (const auto& [key, share] : all_) {
      const std::uint32_t a = smaller_end(key), b = larger_end(key);
      if (share >= kSnap && share <= 1 - kSnap) continue;
      const Vec3 to = world(a) + (world(b) - world(a)) * share;
      const std::uint32_t v = share < kSnap ? a : b;
      const double length = norm(to - world(v));
      const auto [at, fresh] = moves.try_emplace(v, Move{length, to});
      if (!fresh && length < at->second.length) at->second = {length, to};
    }
    for (const auto& [v, move] : moves) put_on_cut(v, move.to);
    return !moves.empty();
  }

  void put_on_cut(std::uint32_t v, const Vec3& to) {
    mesh_.vertices[v] = Vec3f(to - mesh_.origin);
    on_cut_[v] = 1;
  }

  /// Finds where the border of the cut crosses triangles; points at edges and corners are assigned to these.
  void find_tips() {
    std::vector<std::uint8_t> tipped(mesh_.triangles.size());
    parallel_ranges(0, mesh_.triangles.size(), kEdgesAtATime, [&](std::size_t first, std::size_t end) {
      std::vector<Vec3> found;
      for (std::size_t i = first; i < end; ++i) {
        const Triangle& t = mesh_.triangles[i];
        if (!good(t)) continue;
        found.clear();
        cut_.border_points(world(t[0]), world(t[1]), world(t[2]), found);
        tipped[i] = !found.empty();
      }
    });
    tips_.clear();
    std::vector<Vec3> found;
    for (std::size_t i = 0; i < tipped.size(); ++i) {
      if (!tipped[i]) continue;
      const Triangle& t = mesh_.triangles[i];
      const Vec3 a = world(t[0]), b = world(t[1]), c = world(t[2]), n = cross(b - a, c - a);
      found.clear();
      cut_.border_points(a, b, c, found);
      for (const Vec3& p : found) {
        const double area = squared_norm(n);
        const std::array<double, 3> share = {dot(cross(b - p, c - p), n) / area, dot(cross(c - p, a - p), n) / area,
                                             dot(cross(a - p, b - p), n) / area};
        const auto least = static_cast<std::size_t>(std::min_element(share.begin(), share.end()) - share.begin());
        const auto most = static_cast<std::size_t>(std::max_element(share.begin(), share.end()) - share.begin());
        if (share[most] > 1 - 2 * kSnap) {  // at a corner
          if (!on_cut_[t[most]]) put_on_cut(t[most], p);
        } else if (share[least] < kSnap) {  // on an edge
          const std::uint32_t v = t[(least + 1) % 3], w = t[(least + 2) % 3];
          const double along = share[(least + 2) % 3] / (share[(least + 1) % 3] + share[(least + 2) % 3]);
          const CutPoint point{v < w ? along : 1 - along};
          const auto [at, fresh] = cut_points_.try_emplace(edge_key(v, w), point);
          // On an edge along the cut, rounding decides the position of the crossing.
          if (!fresh && runs_along(v, w)) at->second = point;
        } else {
          tips_[i].push_back(p);
        }
      }
    }
    // Crossings now at a vertex are no longer on an edge.
    for (auto at = cut_points_.begin(); at != cut_points_.end();) {
      const bool gone = (on_cut_[smaller_end(at->first)] && at->second.share < 2 * kSnap) ||
                        (on_cut_[larger_end(at->first)] && at->second.share > 1 - 2 * kSnap);
      at = gone ? cut_points_.erase(at) : std::next(at);
    }
  }

  /// Whether the cut runs along an edge from one of its ends, which is on it, to the crossing on the edge.
  bool runs_along(std::uint32_t v, std::uint32_t w) const {
    const std::uint64_t key = edge_key(v, w);
    const auto point = cut_points_.find(key);
    if (point == cut_points_.end() || (on_cut_[v] != 0) == (on_cut_[w] != 0)) return false;
    const Vec3 a = world(smaller_end(key)), b = world(larger_end(key));
    const double share = point->second.share;
    return lies_at(a + (b - a) * (on_cut_[smaller_end(key)] ? share / 2 : (1 + share) / 2), norm(b - a));
  }
  bool lies_along(std::uint64_t key) const {
    const Vec3 a = world(smaller_end(key)), b = world(larger_end(key));
    for (const double share : {0.25, 0.5, 0.75})
      if (!lies_at(a + (b - a) * share, norm(b - a))) return false;
    return true;
  }
  bool lies_at(const Vec3& p, double edge) const {
    Gap gap;
    cut_.gaps({&p, 1}, {&p, 1}, {}, {&gap, 1});  // depth <= −distance/2
    return gap.depth > -kSnap * edge;
  }

  /// Classifies how the cut crosses each triangle, and finds the edges along the cut.
  void look_at_triangles(bool last) {
    bad_.clear(), ways_.clear(), cut_edges_.clear();
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
      const Triangle& t = mesh_.triangles[i];
      if (!good(t)) continue;
      std::size_t corners = 0, edges = 0, along = 0;
      bool bad = false, beside = false;  // a corner on the cut, and a crossing on an edge at that corner
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint64_t key = edge_key(t[k], t[(k + 1) % 3]);
        corners += on_cut_[t[k]];
        bad = bad || twice_.count(key) != 0;
        if (cut_points_.count(key) == 0) continue;
        ++edges;
        if (runs_along(t[k], t[(k + 1) % 3])) {
          ++along;
          continue;
        }
        beside = beside || on_cut_[t[k]] || on_cut_[t[(k + 1) % 3]];
      }
      std::vector<Vec3> tips;
      if (const auto at = tips_.find(i); at != tips_.end()) tips = at->second;
      // A tip next to the crossing where the cut enters is that crossing.
      std::erase_if(tips, [&](const Vec3& p) { return near_a_cut_point(t, p); });
      const std::size_t n = corners + edges;
      Look look;
      if (!bad && along == 1 && n == 2 && tips.empty()) {
        look.way = Way::along;
      } else if (!bad && !beside && along == 0 && n == 2 && tips.empty()) {
        look.way = Way::across;
      } else if (!bad && n == 1 && tips.size() == 1) {
        look = {Way::ending, tips[0]};
      } else if (bad || tips.size() > 1 || n > 3 || (n == 3 && edges > 0) || (n == 2 && !tips.empty()) || beside ||
                 along > 0) {
        bad_.push_back(i);
        continue;
      } else {
        continue;
      }
      ways_[i] = look;
    }
    if (!last && !bad_.empty()) return;
    for (const auto& [i, look] : ways_) {
      const Triangle& t = mesh_.triangles[i];
      if (look.way != Way::across) continue;
      for (std::size_t k = 0; k < 3; ++k)
        if (on_cut_[t[k]] && on_cut_[t[(k + 1) % 3]]) cut_edges_.insert(edge_key(t[k], t[(k + 1) % 3]));
    }
  }

  bool near_a_cut_point(const Triangle& t, const Vec3& p) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 a = world(t[k]), b = world(t[(k + 1) % 3]);
      const double close = kSnap * norm(b - a);
      if (on_cut_[t[k]] && norm(p - a) < close) return true;
      const auto at = cut_points_.find(edge_key(t[k], t[(k + 1) % 3]));
      if (at == cut_points_.end()) continue;
      const double share = t[k] < t[(k + 1) % 3] ? at->second.share : 1 - at->second.share;
      if (norm(p - (a + (b - a) * share)) < close) return true;
    }
    return false;
  }

  std::uint32_t vertex_on(std::uint32_t a, std::uint32_t b) {
    const std::uint64_t key = edge_key(a, b);
    const auto point = cut_points_.find(key);
    if (point == cut_points_.end()) return kNoVertex;
    const auto [at, fresh] = made_.try_emplace(key, kNoVertex);
    if (fresh) {
      const std::uint32_t v = smaller_end(key), w = larger_end(key);
      const double share = point->second.share;
      const Vec3 x = Vec3(mesh_.vertices[v]) + (Vec3(mesh_.vertices[w]) - Vec3(mesh_.vertices[v])) * share;
      at->second = append_vertex_between(mesh_, v, w, static_cast<float>(share), Vec3f(x));
    }
    return at->second;
  }

  /// A vertex inside a triangle, interpolated from all three corners.
  std::uint32_t vertex_within(const Triangle& t, const Vec3& p) {
    const Vec3 a = world(t[0]), b = world(t[1]), c = world(t[2]), n = cross(b - a, c - a);
    const double area = squared_norm(n), wb = std::max(0.0, dot(cross(c - p, a - p), n) / area),
                 wc = std::max(0.0, dot(cross(a - p, b - p), n) / area);
    // Interpolates twice: on the edge from b to c, and from a to that point. The first vertex is temporary.
    const double along = wb + wc > 0 ? wc / (wb + wc) : 0;
    const Vec3 x = p - mesh_.origin;
    const std::uint32_t between = append_vertex_between(mesh_, t[1], t[2], static_cast<float>(along), Vec3f(x));
    const std::uint32_t tip =
        append_vertex_between(mesh_, t[0], between, static_cast<float>(std::min(1.0, wb + wc)), Vec3f(x));
    unused_.push_back(between);
    return tip;
  }

  void split_triangles() {
    std::vector<Triangle> result;
    std::vector<std::uint32_t> of;
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) { result.push_back({a, b, c}); };
    for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
      Triangle t = mesh_.triangles[i];
      of.resize(result.size(), i == 0 ? 0 : static_cast<std::uint32_t>(i - 1));
      if (!good(t)) {
        result.push_back(t);
        continue;
      }
      std::array<std::uint32_t, 3> m{};
      for (std::size_t k = 0; k < 3; ++k) m[k] = vertex_on(t[k], t[(k + 1) % 3]);
      const auto splits = std::count_if(m.begin(), m.end(), [](std::uint32_t v) { return v != kNoVertex; });
      const auto at = ways_.find(i);
      const Look look = at == ways_.end() ? Look{} : at->second;
      const auto turn = [&] {
        std::rotate(t.begin(), t.begin() + 1, t.end());
        std::rotate(m.begin(), m.begin() + 1, m.end());
      };
      // Rotate so that the split edges come first.
      while ((splits == 1 && m[0] == kNoVertex) || (splits == 2 && m[2] != kNoVertex)) turn();
      if (look.way == Way::ending) {
        const std::uint32_t tip = vertex_within(t, look.tip);
        if (splits == 1) {
          add(t[0], m[0], tip), add(m[0], t[1], tip), add(t[1], t[2], tip), add(t[2], t[0], tip);
          cut_edges_.insert(edge_key(m[0], tip));
        } else {
          while (!on_cut_[t[0]]) turn();
          add(t[0], t[1], tip), add(t[1], t[2], tip), add(t[2], t[0], tip);
          cut_edges_.insert(edge_key(t[0], tip));
        }
      } else if (splits == 0) {
        result.push_back(t);
      } else if (splits == 1) {
        add(t[0], m[0], t[2]), add(m[0], t[1], t[2]);
        if (look.way == Way::across) cut_edges_.insert(edge_key(m[0], t[2]));
        if (look.way == Way::along) cut_edges_.insert(edge_key(m[0], on_cut_[t[0]] ? t[0] : t[1]));
      } else if (splits == 2) {
        add(m[0], t[1], m[1]);
        if (norm(world(t[0]) - world(m[1])) <= norm(world(m[0]) - world(t[2]))) {
          add(t[0], m[0], m[1]), add(t[0], m[1], t[2]);
        } else {
          add(t[0], m[0], t[2]), add(m[0], m[1], t[2]);
        }
        if (look.way == Way::across) cut_edges_.insert(edge_key(m[0], m[1]));
      } else {
        add(t[0], m[0], m[2]), add(m[0], t[1], m[1]), add(m[2], m[1], t[2]), add(m[0], m[1], m[2]);
      }
    }
    of.resize(result.size(), static_cast<std::uint32_t>(mesh_.triangles.size() - 1));
    mesh_.triangles = std::move(result);
    if (!mesh_.triangle_attributes.empty()) mesh_.triangle_attributes = mesh_.triangle_attributes.taken(of);
    drop_unused();
  }

  /// Removes temporary vertices.
  void drop_unused() {
    if (unused_.empty()) return;
    std::vector<std::uint32_t> kept, now(mesh_.vertices.size());
    std::size_t next = 0;
    for (std::uint32_t v = 0; v < mesh_.vertices.size(); ++v) {
      now[v] = static_cast<std::uint32_t>(kept.size());
      if (next < unused_.size() && unused_[next] == v) {
        ++next;
        continue;
      }
      kept.push_back(v);
    }
    take_vertices(mesh_, kept);
    for (Triangle& t : mesh_.triangles)
      for (std::uint32_t& v : t)
        if (v < now.size()) v = now[v];
    std::unordered_set<std::uint64_t> edges;
    for (const std::uint64_t e : cut_edges_) edges.insert(edge_key(now[smaller_end(e)], now[larger_end(e)]));
    cut_edges_ = std::move(edges);
  }

  /// Offset by a fraction of the vector from a vertex to the centroid of the triangles on one side. Rounding may have
  /// moved the vertex across the cut; the fraction then counts from the crossing.
  Vec3f offset_to(std::uint32_t v, const Vec3& way) const {
    std::vector<double> found;
    for (const auto& cut : cuts_) cut->crossings(world(v), world(v) + way, found);
    double share = 0;
    for (const double at : found)
      if (at < kMostRounded) share = std::max(share, at);
    return Vec3f(way * (share + static_cast<double>(kAsideShare)));
  }

  /// Doubles vertices: triangles around a vertex stay together if uncut edges connect them. Triangles with an invalid
  /// corner are connected too, but do not distinguish the sides of a cut.
  void part(Slit& slit) {
    std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> around;  // triangles
    for (const std::uint64_t e : cut_edges_) around[smaller_end(e)], around[larger_end(e)];
    for (std::uint32_t i = 0; i < mesh_.triangles.size(); ++i) {
      if (!has_distinct_corners(mesh_.triangles[i])) continue;
      for (const std::uint32_t v : mesh_.triangles[i])
        if (const auto at = around.find(v); at != around.end()) at->second.push_back(i);
    }
    std::vector<std::uint32_t> vertices;
    vertices.reserve(around.size());
    for (const auto& entry : around) vertices.push_back(entry.first);
    std::sort(vertices.begin(), vertices.end());

    const std::vector<Triangle> before = mesh_.triangles;
    std::vector<std::uint32_t> aside;
    std::vector<Vec3f> offsets;
    for (const std::uint32_t v : vertices) {
      const std::vector<std::uint32_t>& fan = around.at(v);
      UnionFind groups(fan.size());
      std::map<std::uint32_t, std::uint32_t> first;  // first triangle at the other end of an edge
      for (std::uint32_t k = 0; k < fan.size(); ++k)
        for (const std::uint32_t w : before[fan[k]]) {
          if (w == v || cut_edges_.count(edge_key(v, w)) != 0) continue;
          const auto [at, fresh] = first.try_emplace(w, k);
          if (!fresh) groups.join(at->second, k);
        }
      std::map<std::uint32_t, std::uint32_t> copies;  // by first triangle of the group
      for (std::uint32_t k = 0; k < fan.size(); ++k) {
        const std::uint32_t g = groups.find(k);
        const auto [at, fresh] = copies.try_emplace(g, v);
        if (fresh && copies.size() > 1) at->second = append_vertex_copy(mesh_, v), ++slit.doubled;
        for (std::uint32_t& w : mesh_.triangles[fan[k]])
          if (w == v) w = at->second;
      }
      if (copies.size() == 1) continue;
      for (const auto& [g, copy] : copies) {
        Vec3 sum;
        double n = 0;
        for (std::uint32_t k = 0; k < fan.size(); ++k) {
          const Triangle& t = before[fan[k]];
          if (groups.find(k) != g || !good(t)) continue;
          sum += (Vec3(mesh_.vertices[t[0]]) + Vec3(mesh_.vertices[t[1]]) + Vec3(mesh_.vertices[t[2]])) / 3.0;
          n += 1;
        }
        aside.push_back(copy);
        offsets.push_back(n > 0 ? offset_to(v, sum / n - Vec3(mesh_.vertices[v])) : Vec3f{});
      }
    }
    set_cut_sides(mesh_, aside, offsets);

    std::unordered_map<std::uint64_t, std::size_t> index;
    for (std::size_t i = 0; i < before.size(); ++i)
      for (std::size_t k = 0; k < 3 && good(before[i]); ++k) {
        const std::uint64_t key = edge_key(before[i][k], before[i][(k + 1) % 3]);
        if (cut_edges_.count(key) == 0) continue;
        const Triangle& t = mesh_.triangles[i];
        const auto [at, fresh] = index.try_emplace(key, slit.edges.size());
        if (fresh) {
          slit.edges.push_back({{t[k], t[(k + 1) % 3]}, {kNoVertex, kNoVertex}, t[(k + 2) % 3], kNoVertex});
          continue;
        }
        SlitEdge& e = slit.edges[at->second];
        e.second = {t[(k + 1) % 3], t[k]}, e.beside_second = t[(k + 2) % 3];
      }
  }

  TriangleMesh& mesh_;
  std::span<const std::shared_ptr<const Occluder>> cuts_;  // the last one and those before
  const Occluder& cut_;
  std::vector<std::uint8_t> on_cut_;  // per vertex
  std::vector<std::pair<std::uint64_t, double>> all_;
  std::map<std::uint64_t, CutPoint> cut_points_;  // split positions of edges
  std::unordered_set<std::uint64_t> twice_;
  std::map<std::size_t, std::vector<Vec3>> tips_;  // by triangle
  std::map<std::size_t, Look> ways_;
  std::vector<std::size_t> bad_;
  std::unordered_set<std::uint64_t> cut_edges_;
  std::map<std::uint64_t, std::uint32_t> made_;
  std::vector<std::uint32_t> unused_;
};

}  // namespace

void set_cut_sides(TriangleMesh& mesh, const std::vector<std::uint32_t>& vertices, const std::vector<Vec3f>& offsets) {
  std::vector<float> sides(3 * mesh.vertices.size());
  if (const std::vector<float>* known = mesh.attributes.find<float>(kCutSide)) sides = *known;
  for (std::size_t i = 0; i < vertices.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) sides[3 * vertices[i] + k] = offsets[i][k];
  mesh.attributes.set(kCutSide, std::move(sides), 3);
}

Slit open_slit(TriangleMesh& mesh, std::span<const std::shared_ptr<const Occluder>> cuts, int refinements) {
  return SlitMaker(mesh, cuts).make(refinements);
}

}  // namespace sansmesh::inline v1
