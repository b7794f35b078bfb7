#include "sansmesh/mesh/booleans/mesh_booleans.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/mesh/booleans/arrangement.h"
#include "sansmesh/mesh/booleans/flat_triangles.h"
#include "sansmesh/mesh/booleans/piece_patches.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::uint32_t kMatched = ~std::uint32_t{0};

/// A kept piece with its final orientation.
struct KeptPiece {
  Triangle vertex;
  std::uint32_t triangle;
  bool reversed;
  bool cut;
};

/// Outward, of length 1.
Vec3 normal_of(const SolidTriangles& in, const KeptPiece& face) {
  const Triangle& t = in.triangles[face.triangle];
  const Vec3 n = normalized(cross(in.corners[t[1]] - in.corners[t[0]], in.corners[t[2]] - in.corners[t[0]]));
  return face.reversed ? -n : n;
}

/// One face at an edge from a to b, a < b.
struct FaceAtEdge {
  std::uint32_t corner;  ///< 3 · face + edge
  bool forward;          ///< runs from a to b
  double angle = 0;
};

/// Makes the faces manifold: duplicates vertices where more than one fan of faces meets.
class Fans {
 public:
  Fans(const SolidTriangles& in, std::vector<KeptPiece>& faces, std::size_t vertices,
       const std::vector<Vec3>& positions)
      : in_(in), faces_(faces), positions_(positions), corners_(3 * faces.size()), vertices_(vertices) {}

  /// Corner classes: vertex of the arrangement of each new vertex; faces then have new vertices.
  std::vector<std::uint32_t> run() {
    std::vector<KeyIndex> edges(3 * faces_.size());
    parallel_for(0, faces_.size(), 8192, [&](std::size_t f) {
      for (std::size_t e = 0; e < 3; ++e) {
        const auto [low, high] = std::minmax(faces_[f].vertex[e], faces_[f].vertex[(e + 1) % 3]);
        edges[3 * f + e] = {std::uint64_t{low} << 32 | high, static_cast<unsigned>(3 * f + e)};
      }
    });
    parallel_sort(edges);
    for (std::size_t first = 0, end = 0; first < edges.size(); first = end) {
      for (end = first; end < edges.size() && edges[end].key == edges[first].key;) ++end;
      if (end - first == 2) {
        join(edges[first].index, edges[first + 1].index);
      } else {
        join_sorted(std::span(edges).subspan(first, end - first));
      }
    }
    return numbered();
  }

 private:
  std::uint32_t at(std::uint32_t corner) const { return faces_[corner / 3].vertex[corner % 3]; }
  static std::uint32_t next(std::uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

  /// Two faces with opposite directions of a common edge.
  void join(std::uint32_t a, std::uint32_t b) {
    corners_.join(a, next(b));
    corners_.join(next(a), b);
  }

  Vec3 normal(std::uint32_t face) const { return normal_of(in_, faces_[face]); }

  /// Joins the two faces of each wedge of the solid around an edge.
  void join_sorted(std::span<const KeyIndex> edges) {
    std::vector<FaceAtEdge> around;
    const auto low = static_cast<std::uint32_t>(edges[0].key >> 32);
    for (const KeyIndex& e : edges) around.push_back({e.index, at(e.index) == low});
    // The edge is on the planes of its faces: their normals have its direction more precisely than its ends.
    const Vec3 n0 = normal(around[0].corner / 3);
    Vec3 along;
    for (const FaceAtEdge& f : around) {
      const Vec3 c = cross(n0, normal(f.corner / 3));
      if (squared_norm(c) > squared_norm(along)) along = c;
    }
    const Vec3 rough = positions_[at(next(around[0].corner))] - positions_[at(around[0].corner)];
    const Vec3 forward = around[0].forward ? rough : -rough;
    if (squared_norm(along) < 1e-6) along = forward;
    along = normalized(dot(along, forward) < 0 ? -along : along);
    Vec3 x = normalized(cross(n0, along));
    const Vec3 y = cross(along, x);
    for (FaceAtEdge& f : around) {
      const Vec3 inward = cross(normal(f.corner / 3), f.forward ? along : -along);
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

  const SolidTriangles& in_;
  std::vector<KeptPiece>& faces_;
  const std::vector<Vec3>& positions_;
  UnionFind corners_;
  std::size_t vertices_;
};

/// All solids in one list; first corner of each.
std::vector<std::uint32_t> pooled(std::span<const SolidFaces> solids, SolidTriangles& in) {
  std::vector<std::uint32_t> first;
  in.solids = solids.size();
  for (std::uint32_t s = 0; s < solids.size(); ++s) {
    const auto shift = static_cast<std::uint32_t>(in.corners.size());
    first.push_back(shift);
    in.corners.insert(in.corners.end(), solids[s].vertices.begin(), solids[s].vertices.end());
    for (const Triangle& t : without_flat_triangles(solids[s])) {
      in.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
      in.solid_of.push_back(s);
    }
  }
  return first;
}

}  // namespace

bool encloses(const SolidFaces& faces) {
  // Directed edges, as an edge and its direction.
  std::vector<std::uint64_t> edges(3 * faces.triangles.size());
  parallel_for(0, faces.triangles.size(), 8192, [&](std::size_t t) {
    for (std::size_t e = 0; e < 3; ++e) {
      const std::uint32_t a = faces.triangles[t][e], b = faces.triangles[t][(e + 1) % 3];
      edges[3 * t + e] = (std::uint64_t{std::min(a, b)} << 33) | (std::uint64_t{std::max(a, b)} << 1) | (a < b ? 1 : 0);
    }
  });
  parallel_sort(edges);
  for (std::size_t i = 0; i < edges.size();) {
    int balance = 0;
    for (const std::uint64_t edge = edges[i] >> 1; i < edges.size() && edges[i] >> 1 == edge; ++i)
      balance += (edges[i] & 1) != 0 ? 1 : -1;
    if (balance != 0) return false;
  }
  return true;
}

BooleanResult combine_solids(std::span<const SolidFaces> solids, const BooleanExpression& expression,
                             Progress& progress) {
  SolidTriangles in;
  progress.begin("arrange triangles");
  const std::vector<std::uint32_t> first = pooled(solids, in);
  const ExactSpace space(in.corners);
  const std::vector<Box3f> boxes = triangle_boxes(in);
  const BoxTree tree(boxes);
  const Arrangement arrangement = arrange(in, space, tree, boxes);
  progress.begin("classify patches");
  const PiecePatches patches = find_patches(in, arrangement);
  const std::vector<PatchUse> use = use_patches(in, space, tree, arrangement, patches, expression);

  progress.begin("assemble mesh");
  std::vector<KeptPiece> faces;
  BooleanResult result;
  result.patches = patches.count;
  for (std::size_t p = 0; p < arrangement.pieces.size(); ++p) {
    const Piece& piece = arrangement.pieces[p];
    result.cut_triangles += piece.cut && (p == 0 || arrangement.pieces[p - 1].triangle != piece.triangle);
    const PatchUse used = use[patches.of_piece[p]];
    if (used == PatchUse::dropped) continue;
    Triangle v = piece.vertex;
    if (used == PatchUse::reversed) std::swap(v[1], v[2]);
    faces.push_back({v, piece.triangle, used == PatchUse::reversed, piece.cut});
  }
  const std::size_t vertices = arrangement.corners + arrangement.seam.size();
  std::vector<Vec3> positions(vertices);
  std::copy(in.corners.begin(), in.corners.end(), positions.begin());
  parallel_for(0, arrangement.seam.size(), 256, [&](std::size_t i) {
    positions[arrangement.corners + i] = space.rounded(arrangement.seam[i]);
  });
  const std::vector<std::uint32_t> source = Fans(in, faces, vertices, positions).run();
  result.vertices.resize(source.size());
  result.sources.resize(source.size());
  for (std::size_t v = 0; v < source.size(); ++v) {
    result.vertices[v] = positions[source[v]];
    if (source[v] >= arrangement.corners) {
      ++result.seam_vertices;
      continue;
    }
    const auto solid = static_cast<std::uint32_t>(std::upper_bound(first.begin(), first.end(), source[v]) -
                                                  first.begin() - 1);
    result.sources[v] = {solid, source[v] - first[solid], true};
  }
  result.triangles.reserve(faces.size());
  for (const KeptPiece& f : faces) {
    if (f.cut) result.cut_faces.push_back({static_cast<std::uint32_t>(result.triangles.size()), normal_of(in, f)});
    result.triangles.push_back(f.vertex);
  }
  return result;
}

}  // namespace sansmesh::inline v1
