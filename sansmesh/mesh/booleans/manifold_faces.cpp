#include "sansmesh/mesh/booleans/manifold_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include "sansmesh/core/union_find.h"
#include "sansmesh/mesh/booleans/edge_groups.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::uint32_t kMatched = ~std::uint32_t{0};

/// One face at an edge from a to b, a < b.
struct FaceAtEdge {
  std::uint32_t corner;  ///< 3 · face + edge
  bool forward;          ///< runs from a to b
  double angle = 0;
};

class FaceFans {
 public:
  FaceFans(const SolidTriangles& in, std::vector<KeptPiece>& faces, std::vector<Vec3>& positions)
      : in_(in), faces_(faces), positions_(positions), corners_(3 * faces.size()), vertices_(positions.size()) {}

  std::optional<std::vector<std::uint32_t>> run() {
    const std::vector<KeyIndex> edges =
        sorted_edges(faces_.size(), vertices_, [&](std::size_t f) -> const Triangle& { return faces_[f].vertex; });
    for (std::size_t first = 0, end = 0; first < edges.size(); first = end) {
      for (end = first; end < edges.size() && edges[end].key == edges[first].key;) ++end;
      int balance = 0;
      for (std::size_t i = first; i < end; ++i) balance += at(edges[i].index) == edges[i].key >> 32 ? 1 : -1;
      if (balance != 0) return std::nullopt;
      if (end - first == 2) {
        join(edges[first].index, edges[first + 1].index);
      } else {
        join_sorted(std::span(edges).subspan(first, end - first));
      }
    }
    std::vector<std::uint32_t> source = numbered();
    split_equal_edges(source);
    return source;
  }

 private:
  std::uint32_t at(std::uint32_t corner) const { return faces_[corner / 3].vertex[corner % 3]; }
  static std::uint32_t next(std::uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

  /// Two faces with opposite directions of a common edge.
  void join(std::uint32_t a, std::uint32_t b) {
    corners_.join(a, next(b));
    corners_.join(next(a), b);
  }

  /// Joins the two faces of each wedge of the solid around an edge.
  void join_sorted(std::span<const KeyIndex> edges) {
    std::vector<FaceAtEdge> around;
    const auto low = static_cast<std::uint32_t>(edges[0].key >> 32);
    for (const KeyIndex& e : edges) around.push_back({e.index, at(e.index) == low});
    // The edge is on the planes of its faces: their normals have its direction more precisely than its ends.
    const Vec3 n0 = kept_normal(in_, faces_[around[0].corner / 3]);
    Vec3 along;
    for (const FaceAtEdge& f : around) {
      const Vec3 c = cross(n0, kept_normal(in_, faces_[f.corner / 3]));
      if (squared_norm(c) > squared_norm(along)) along = c;
    }
    const Vec3 rough = positions_[at(next(around[0].corner))] - positions_[at(around[0].corner)];
    const Vec3 forward = around[0].forward ? rough : -rough;
    if (squared_norm(along) < 1e-6) along = forward;
    along = normalized(dot(along, forward) < 0 ? -along : along);
    Vec3 x = normalized(cross(n0, along));
    const Vec3 y = cross(along, x);
    for (FaceAtEdge& f : around) {
      const Vec3 inward = cross(kept_normal(in_, faces_[f.corner / 3]), f.forward ? along : -along);
      f.angle = std::atan2(dot(inward, y), dot(inward, x));
    }
    std::sort(around.begin(), around.end(), [](const FaceAtEdge& a, const FaceAtEdge& b) {
      return a.angle != b.angle ? a.angle < b.angle : a.corner < b.corner;
    });
    // Counter-clockwise, the solid begins at a backward face and ends at the next forward one. Rounding may hide an
    // order: like brackets, the nearest open pairs match.
    std::vector<std::uint32_t> open;
    for (std::size_t i = 0; i < 2 * around.size(); ++i) {
      FaceAtEdge& f = around[i % around.size()];
      if (f.corner == kMatched) continue;
      if (!f.forward && i < around.size()) open.push_back(static_cast<std::uint32_t>(i));
      if (f.forward && !open.empty()) {
        FaceAtEdge& back = around[open.back()];
        open.pop_back();
        join(back.corner, f.corner);
        shared_.push_back({back.corner, f.corner});
        back.corner = f.corner = kMatched;
      }
    }
  }

  /// Vertices in use in the order of their numbers; copies of one are neighbours.
  std::vector<std::uint32_t> numbered() {
    std::vector<std::uint32_t> copies(vertices_ + 1, 0);
    const auto corners = static_cast<std::uint32_t>(3 * faces_.size());
    std::vector<std::uint32_t> rank(corners);
    for (std::uint32_t c = 0; c < corners; ++c)
      if (corners_.find(c) == c) rank[c] = copies[at(c) + 1]++;
    for (std::size_t v = 0; v < vertices_; ++v) copies[v + 1] += copies[v];
    std::vector<std::uint32_t> source(copies[vertices_]);
    for (std::size_t v = 0; v < vertices_; ++v)
      for (std::uint32_t i = copies[v]; i < copies[v + 1]; ++i) source[i] = static_cast<std::uint32_t>(v);
    std::vector<Triangle> named(faces_.size());
    for (std::uint32_t c = 0; c < corners; ++c) named[c / 3][c % 3] = copies[at(c)] + rank[corners_.find(c)];
    for (std::size_t f = 0; f < faces_.size(); ++f) faces_[f].vertex = named[f];
    return source;
  }

  /// Pairs of faces at an edge whose ends they share with another pair there: the first pair keeps the edge.
  void split_equal_edges(std::vector<std::uint32_t>& source) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::array<std::uint32_t, 2>> seen;
    std::vector<std::array<std::uint32_t, 2>> equal;  // ends, from the first face's view
    std::vector<std::array<std::uint32_t, 2>> owners;
    for (const auto& [a, b] : shared_) {
      const std::uint32_t from = at(a), to = at(next(a));
      if (seen.try_emplace(std::minmax(from, to), std::array{a, b}).second) continue;
      equal.push_back({from, to});
      owners.push_back({a / 3, b / 3});
    }
    // Parts of split faces: an edge may be in a later part of its face.
    std::multimap<std::uint32_t, std::uint32_t> parts;
    for (std::size_t i = 0; i < equal.size(); ++i) {
      const auto [from, to] = equal[i];
      const auto middle = static_cast<std::uint32_t>(source.size());
      source.push_back(static_cast<std::uint32_t>(positions_.size()));
      positions_.push_back((positions_[source[from]] + positions_[source[to]]) * 0.5);
      split(parts, owners[i][0], from, to, middle);
      split(parts, owners[i][1], to, from, middle);
    }
  }

  void split(std::multimap<std::uint32_t, std::uint32_t>& parts, std::uint32_t owner, std::uint32_t from,
             std::uint32_t to, std::uint32_t middle) {
    std::vector<std::uint32_t> candidates{owner};
    for (auto [p, end] = parts.equal_range(owner); p != end; ++p) candidates.push_back(p->second);
    for (const std::uint32_t f : candidates)
      for (std::size_t e = 0; e < 3; ++e) {
        if (faces_[f].vertex[e] != from || faces_[f].vertex[(e + 1) % 3] != to) continue;
        KeptPiece rest = faces_[f];
        faces_[f].vertex[(e + 1) % 3] = rest.vertex[e] = middle;
        faces_[f].cut = rest.cut = true;
        parts.emplace(owner, static_cast<std::uint32_t>(faces_.size()));
        faces_.push_back(rest);
        return;
      }
  }

  const SolidTriangles& in_;
  std::vector<KeptPiece>& faces_;
  std::vector<Vec3>& positions_;
  std::vector<std::array<std::uint32_t, 2>> shared_;  ///< joined corners at edges of more than two faces
  UnionFind corners_;
  std::size_t vertices_;
};

}  // namespace

Vec3 kept_normal(const SolidTriangles& in, const KeptPiece& face) {
  const Triangle& t = in.triangles[face.triangle];
  const Vec3 n = normalized(cross(in.corners[t[1]] - in.corners[t[0]], in.corners[t[2]] - in.corners[t[0]]));
  return face.reversed ? -n : n;
}

std::optional<std::vector<std::uint32_t>> make_manifold(const SolidTriangles& in, std::vector<Vec3>& positions,
                                                        std::vector<KeptPiece>& faces) {
  return FaceFans(in, faces, positions).run();
}

}  // namespace sansmesh::inline v1
