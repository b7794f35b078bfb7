#include "sansmesh/mesh/booleans/mesh_booleans.h"

#include <algorithm>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/mesh/booleans/arrangement.h"
#include "sansmesh/mesh/booleans/flat_triangles.h"
#include "sansmesh/mesh/booleans/manifold_faces.h"
#include "sansmesh/mesh/booleans/piece_patches.h"

namespace sansmesh::inline v1 {
namespace {

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

/// The pieces of the result, with their orientation there. Counts cut triangles.
std::vector<KeptPiece> kept_faces(const Arrangement& arrangement, const PiecePatches& patches, const PatchUses& use,
                                  BooleanResult& result) {
  std::vector<KeptPiece> faces;
  for (std::size_t p = 0; p < arrangement.pieces.size(); ++p) {
    const Piece& piece = arrangement.pieces[p];
    result.cut_triangles += piece.cut && (p == 0 || arrangement.pieces[p - 1].triangle != piece.triangle);
    const PatchUse used = use.of_patch[patches.of_piece[p]];
    if (used == PatchUse::dropped) continue;
    Triangle v = piece.vertex;
    if (used == PatchUse::reversed) std::swap(v[1], v[2]);
    faces.push_back({v, piece.triangle, used == PatchUse::reversed, piece.cut});
  }
  return faces;
}

std::vector<Vec3> positions_of(const SolidTriangles& in, const ExactSpace& space, const Arrangement& arrangement) {
  std::vector<Vec3> positions(arrangement.corners + arrangement.seam.size());
  std::copy(in.corners.begin(), in.corners.end(), positions.begin());
  parallel_for(0, arrangement.seam.size(), 256,
               [&](std::size_t i) { positions[arrangement.corners + i] = space.rounded(arrangement.seam[i]); });
  return positions;
}

/// `first`: first corner of each solid; `source`: position of each vertex of the faces.
void fill(BooleanResult& result, const SolidTriangles& in, const std::vector<std::uint32_t>& first,
          const std::vector<Vec3>& positions, const std::vector<std::uint32_t>& source,
          const std::vector<KeptPiece>& faces) {
  result.vertices.resize(source.size());
  result.sources.resize(source.size());
  for (std::size_t v = 0; v < source.size(); ++v) {
    result.vertices[v] = positions[source[v]];
    if (source[v] >= in.corners.size()) {
      ++result.seam_vertices;
      continue;
    }
    const auto solid =
        static_cast<std::uint32_t>(std::upper_bound(first.begin(), first.end(), source[v]) - first.begin() - 1);
    result.sources[v] = {solid, source[v] - first[solid], true};
  }
  result.triangles.reserve(faces.size());
  for (const KeptPiece& f : faces) {
    if (f.cut) result.cut_faces.push_back({static_cast<std::uint32_t>(result.triangles.size()), kept_normal(in, f)});
    result.triangles.push_back(f.vertex);
  }
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
  const FaceBoxTree tree(boxes);
  for (const SolidFaces& s : solids) in.resolved.push_back(s.overlaps ? 1 : 0);
  while (true) {
    const Arrangement arrangement = arrange(in, space, tree, boxes);
    progress.begin("classify patches");
    const PiecePatches patches = find_patches(in, arrangement);
    const PatchUses use = use_patches(in, space, tree, arrangement, patches, expression);
    if (use.tangled.empty()) {
      progress.begin("assemble mesh");
      BooleanResult result;
      result.patches = patches.count;
      std::vector<KeptPiece> faces = kept_faces(arrangement, patches, use, result);
      std::vector<Vec3> positions = positions_of(in, space, arrangement);
      const auto source = make_manifold(in, positions, faces);
      const bool last = std::count(in.resolved.begin(), in.resolved.end(), 0) == 0;
      if (source || last) {
        if (source) fill(result, in, first, positions, *source, faces);
        result.closed = source.has_value();
        return result;
      }
    }
    // Solids whose parts overlap each other are arranged with themselves, too.
    for (const std::uint32_t s : use.tangled) in.resolved[s] = 1;
    if (use.tangled.empty()) std::fill(in.resolved.begin(), in.resolved.end(), std::uint8_t{1});
    progress.begin("arrange triangles");
  }
}

}  // namespace sansmesh::inline v1
