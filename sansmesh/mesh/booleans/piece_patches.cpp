#include "sansmesh/mesh/booleans/piece_patches.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/core/union_find.h"
#include "sansmesh/mesh/booleans/edge_groups.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kRayChunk = 16;

/// Solids with a changed winding number beside a patch.
class Windings {
 public:
  struct Entry {
    std::uint32_t solid;
    int above = 0;     ///< winding number on the side of the ray
    int on_patch = 0;  ///< by how much that on the other side is higher
  };
  Entry& of(std::uint32_t solid) {
    for (Entry& e : entries_)
      if (e.solid == solid) return e;
    return entries_.emplace_back(Entry{solid});
  }
  const std::vector<Entry>& entries() const { return entries_; }
  void clear() { entries_.clear(); }

 private:
  std::vector<Entry> entries_;
};

/// Rays from pieces along an axis.
class PatchRays {
 public:
  PatchRays(const SolidTriangles& in, const ExactSpace& space, const FaceBoxTree& tree, const Arrangement& arrangement,
            const BooleanExpression& expression)
      : in_(in), space_(space), tree_(tree), arrangement_(arrangement), state_(expression, in.solids) {}

  PatchUse use(const Piece& piece) {
    const Triangle& own = in_.triangles[piece.triangle];
    axis_ = space_.main_axis(own[0], own[1], own[2]);
    const std::array<ExactPoint, 3> corners{arrangement_.point(space_, piece.vertex[0]),
                                            arrangement_.point(space_, piece.vertex[1]),
                                            arrangement_.point(space_, piece.vertex[2])};
    const ExactMean from = space_.mean(corners[0], corners[1], corners[2]);
    windings_.clear();
    duplicate_ = tangled_ = false;
    tree_.visit(ray_box(from), [&](std::uint32_t t) { return meet(from, piece, t), true; });
    const int facing = space_.turn(own[0], own[1], own[2], axis_);
    if (const std::uint32_t solid = in_.solid_of[piece.triangle]; in_.resolved[solid] == 0) {
      Windings::Entry& self = windings_.of(solid);
      tangled_ = self.above != (facing > 0 ? 0 : 1) || self.on_patch != facing;
      self.above = facing > 0 ? 0 : 1;
      self.on_patch = facing;
    }
    if (duplicate_) return PatchUse::dropped;
    bool along = value(false), against = value(true);
    if (facing < 0) std::swap(along, against);
    if (along == against) return PatchUse::dropped;
    return against ? PatchUse::kept : PatchUse::reversed;
  }
  /// Whether the winding number of the last piece's own solid beside it is not that of a simple solid.
  bool tangled() const { return tangled_; }

 private:
  /// A box around the ray, with room for the rounding of its start.
  Box3f ray_box(const ExactMean& from) const {
    Box3f box;
    for (std::size_t k = 0; k < 3; ++k) {
      const double room = from.at[k].error + std::abs(from.at[k].value) * 1e-6 + 1e-37;
      box.lower[k] = static_cast<float>(from.at[k].value - room);
      box.upper[k] = static_cast<float>(from.at[k].value + room);
    }
    box.upper[static_cast<std::size_t>(axis_)] = std::numeric_limits<float>::infinity();
    return box;
  }

  /// Sign of turn(a, b, from), for a start that is moved by an infinitesimal amount across the ray.
  int side_of_edge(std::uint32_t a, std::uint32_t b, const ExactMean& from) const {
    const int sign = space_.turn(a, b, from, axis_);
    if (sign != 0) return sign;
    const Vec3 &p = space_.position(a), &q = space_.position(b);
    const std::size_t i = static_cast<std::size_t>(axis_ + 1) % 3, j = static_cast<std::size_t>(axis_ + 2) % 3;
    if (p[j] != q[j]) return q[j] < p[j] ? 1 : -1;
    return q[i] > p[i] ? 1 : q[i] < p[i] ? -1 : 0;
  }

  void meet(const ExactMean& from, const Piece& piece, std::uint32_t t) {
    const std::uint32_t solid = in_.solid_of[t], own = in_.solid_of[piece.triangle];
    const Triangle& other = in_.triangles[t];
    const int first = side_of_edge(other[0], other[1], from);
    if (first == 0 || side_of_edge(other[1], other[2], from) != first ||
        side_of_edge(other[2], other[0], from) != first)
      return;
    // `first` is the sign of the normal's component along the ray.
    const int side = space_.side(other[0], other[1], other[2], from) * first;
    if (side < 0) windings_.of(solid).above += first;
    if (side != 0) return;
    windings_.of(solid).on_patch += first;
    if (solid < own || (solid == own && t < piece.triangle && in_.resolved[own] != 0)) duplicate_ = true;
  }

  /// Whether the expression contains the points beside the piece, on the side of the ray or on the other.
  bool value(bool below) {
    for (const Windings::Entry& e : windings_.entries())
      if (e.above + (below ? e.on_patch : 0) > 0) state_.put(e.solid, true);
    const bool inside = state_.value();
    for (const Windings::Entry& e : windings_.entries()) state_.put(e.solid, false);
    return inside;
  }

  const SolidTriangles& in_;
  const ExactSpace& space_;
  const FaceBoxTree& tree_;
  const Arrangement& arrangement_;
  BooleanState state_;
  Windings windings_;
  int axis_ = 0;
  bool duplicate_ = false, tangled_ = false;
};

/// Twice the area of a piece, approximately.
double size_of(const SolidTriangles& in, const Arrangement& a, const Piece& piece) {
  const auto at = [&](std::uint32_t v) { return v < a.corners ? in.corners[v] : a.seam[v - a.corners].approximate(); };
  const Vec3 o = at(piece.vertex[0]);
  return norm(cross(at(piece.vertex[1]) - o, at(piece.vertex[2]) - o));
}

}  // namespace

PiecePatches find_patches(const SolidTriangles& in, const Arrangement& arrangement) {
  const std::vector<Piece>& pieces = arrangement.pieces;
  const std::vector<KeyIndex> edges = sorted_edges(pieces.size(), arrangement.corners + arrangement.seam.size(),
                                                   [&](std::size_t p) -> const Triangle& { return pieces[p].vertex; });
  UnionFind sets(pieces.size());
  for (std::size_t first = 0, end = 0; first < edges.size(); first = end) {
    bool seam = false;
    for (end = first; end < edges.size() && edges[end].key == edges[first].key; ++end)
      seam = seam || pieces[edges[end].index / 3].seam[edges[end].index % 3];
    if (seam || end - first != 2) continue;
    const std::uint32_t a = edges[first].index / 3, b = edges[first + 1].index / 3;
    if (in.solid_of[pieces[a].triangle] == in.solid_of[pieces[b].triangle]) sets.join(a, b);
  }
  PiecePatches patches;
  patches.of_piece.resize(pieces.size());
  for (std::uint32_t p = 0; p < pieces.size(); ++p) {
    const std::uint32_t root = sets.find(p);
    patches.of_piece[p] = root == p ? static_cast<std::uint32_t>(patches.count++) : patches.of_piece[root];
  }
  return patches;
}

PatchUses use_patches(const SolidTriangles& in, const ExactSpace& space, const FaceBoxTree& tree,
                      const Arrangement& arrangement, const PiecePatches& patches,
                      const BooleanExpression& expression) {
  // The ray begins in the largest piece, where rounding matters least.
  std::vector<std::uint32_t> largest(patches.count, ~0u);
  std::vector<double> size(patches.count, -1);
  for (std::uint32_t p = 0; p < arrangement.pieces.size(); ++p) {
    const std::uint32_t patch = patches.of_piece[p];
    const double own = size_of(in, arrangement, arrangement.pieces[p]);
    if (own > size[patch]) size[patch] = own, largest[patch] = p;
  }
  PatchUses use;
  use.of_patch.resize(patches.count);
  std::vector<std::uint8_t> tangled(patches.count, 0);
  parallel_for(0, (patches.count + kRayChunk - 1) / kRayChunk, 1, [&](std::size_t c) {
    PatchRays rays(in, space, tree, arrangement, expression);
    for (std::size_t i = c * kRayChunk; i < std::min(patches.count, (c + 1) * kRayChunk); ++i)
      use.of_patch[i] = rays.use(arrangement.pieces[largest[i]]), tangled[i] = rays.tangled() ? 1 : 0;
  });
  for (std::size_t i = 0; i < patches.count; ++i)
    if (tangled[i] != 0) use.tangled.push_back(in.solid_of[arrangement.pieces[largest[i]].triangle]);
  std::sort(use.tangled.begin(), use.tangled.end());
  use.tangled.erase(std::unique(use.tangled.begin(), use.tangled.end()), use.tangled.end());
  return use;
}

}  // namespace sansmesh::inline v1
