// Cuts the blocks of a lattice along pieces that are linear in each simplex, with exact integer predicates.
#pragma once

#include <algorithm>
#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sansmesh/polygonize/lattice/cell_polygons.h"
#include "sansmesh/polygonize/lattice/lattice.h"
#include "sansmesh/polygonize/pieces/cut_vertices.h"
#include "sansmesh/polygonize/pieces/piece_blocks.h"

namespace sansmesh::inline v1 {

using WideInt = __int128;

/// Bits of the masks of pieces: for nearly all blocks, and for those where many pieces meet. One byte indexes the
/// pieces, a constant plane 1 and the faces of the simplex.
constexpr std::size_t kUsualBits = 64, kManyBits = kMostPiecesInBlock + 1;
static_assert(4 + kMostPiecesInBlock <= 255);
/// Values are integers of this many bits, in units of 2^−kValueBits of the root block's edge. This is twice the
/// necessary range: slopes are at most 1 and blocks at most an eighth of the root, so a relevant piece is at a block's
/// corners at most a quarter of the root's edge from zero; the last bit makes values odd.
constexpr int kValueBits = 40;
/// Three times the product of a value and a minor, which is the difference of two products of two values.
constexpr int kWeightBits = 3 * kValueBits + 3;
static_assert(kWeightBits + 2 < 127, "sums of four weights fit into 128 bits with a sign");
static_assert(kWeightBits - 64 + kValueBits + 2 < 127 && 64 + kValueBits + 2 < 127, "so do those of sign_of_sum");

/// A polygon in the plane of a piece, given by the planes of its edges; vertex i is between edges i − 1 and i. Planes 0
/// to 3 are the faces of the simplex opposite to its vertices, followed by pieces.
template <class Mask>
struct PieceCell {
  std::vector<std::uint8_t> edge;
  Mask negative;  ///< pieces that are negative in it
};

/// Surface in a cell (an eighth of a block): none, a single piece, or several pieces.
enum class CellState : std::uint8_t { empty, single, several };
/// For all cells of a block, two bits each.
using CellStates = std::uint16_t;
constexpr CellStates kAllSeveral = 0xaaaa;
inline CellState state_of(CellStates all, std::size_t cell) { return static_cast<CellState>(all >> (2 * cell) & 3u); }

/// Pattern of blocks without finer neighbours: slots by position on the grid of half edges, and the cell of each
/// simplex.
struct PlainPattern {
  static constexpr std::size_t kSlots = 27;
  const BlockPattern* pattern;
  std::array<std::uint8_t, kSlots> slot{};
  std::vector<std::uint8_t> cell_of_tet;

  explicit PlainPattern(const BlockPattern& plain) : pattern(&plain) {
    for (std::size_t i = 0; i < plain.slots.size(); ++i) {
      const std::size_t s = plain.slots[i];
      slot[s % 5 / 2 + 3 * (s / 5 % 5 / 2) + 9 * (s / 50)] = static_cast<std::uint8_t>(i);
    }
    for (const auto& tet : plain.tets) {
      std::size_t low[3] = {2, 2, 2}, high[3] = {2, 2, 2};
      for (const std::uint8_t i : tet) {
        const std::size_t s = plain.slots[i], q[3] = {s % 5, s / 5 % 5, s / 25};
        for (std::size_t k = 0; k < 3; ++k) low[k] = std::min(low[k], q[k]), high[k] = std::max(high[k], q[k]);
      }
      unsigned cell = 0;
      for (std::size_t k = 0; k < 3; ++k) cell |= high[k] == 4 ? 1u << k : 0u;
      cell_of_tet.push_back(static_cast<std::uint8_t>(cell));
    }
  }
  /// Slot of corner c of a cell.
  std::size_t corner(std::size_t cell, std::size_t c) const {
    std::size_t at = 0, step = 1;
    for (std::size_t k = 0; k < 3; ++k, step *= 3) at += ((cell >> k & 1u) + (c >> k & 1u)) * step;
    return slot[at];
  }
};

/// Cuts blocks with fewer than `Bits` pieces, one at a time.
template <std::size_t Bits>
class PieceCutter {
 public:
  using Mask = std::bitset<Bits>;
  PieceCutter(const PieceExpression& field, const PieceBlocks& blocks, double quantum, const PlainPattern& plain,
              CutChunk& out)
      : field_(field),
        blocks_(blocks),
        quantum_(quantum),
        largest_(quantum * (0x1p-1 * (std::int64_t{1} << kValueBits) - 1)),
        plain_(plain),
        out_(out) {}

  /// State of the cells of a block.
  CellStates look(std::size_t leaf, const BlockPattern& pattern, std::span<const Vec3> x);

  /// `beside`: the cells of the blocks that share a face (2·axis + side). Returns false, without effect, if the block
  /// has too many pieces.
  bool cut(std::size_t leaf, const BlockPattern& pattern, std::span<const std::uint32_t> numbers,
           std::span<const Vec3> x, CellStates own, const std::array<CellStates, 6>& beside);

 private:
  /// Loads nodes, pieces and values of a block; false if there are too many pieces.
  bool load(std::size_t leaf, const BlockPattern& pattern, std::span<const Vec3> x);

  [[noreturn]] static void too_steep(const Vec3& x);

  /// Reduces the expression, given the pieces that are negative at all or at any corners.
  KnownSign reduce(const Mask& all, const Mask& any);

  CellState look_at(std::size_t cell, std::size_t& piece);

  /// Whether another sheet is close by and face to face or back to back with the piece's: simplices then divide both in
  /// the same way, so that the part between keeps its thickness.
  bool has_other_side(std::size_t cell, std::size_t piece, double edge) const;

  /// A cell with one piece: simplices are needed only at faces shared with cells that use them.
  void cut_cell(std::size_t cell, CellStates own, const std::array<CellStates, 6>& beside);

  /// Index of a constant 1 in place of a piece.
  static constexpr std::size_t kOnes = Bits - 1;
  std::int64_t value(std::size_t piece, std::size_t corner) const {
    return piece == kOnes ? 1 : values_[piece * slots_ + tet_[corner]];
  }

  void cut_simplex(const Mask& all, const Mask& any);

  // ---- One piece ------------------------------------------------------------------------------------------------

  std::uint32_t on_edge(std::size_t piece, std::size_t i, std::size_t j) { return between(piece, tet_[i], tet_[j]); }

  /// Vertex where the piece vanishes between two slots.
  std::uint32_t between(std::size_t piece, std::size_t i, std::size_t j);

  /// Distance of a point of a piece from sheets back to back with it, or face to face.
  float room_beside(std::size_t piece, const Vec3& x) const;

  std::uint32_t add(const Vec3& x) {
    out_.x.push_back(x);
    out_.size.push_back(size_);
    out_.room.push_back(std::numeric_limits<float>::infinity());
    return static_cast<std::uint32_t>(out_.x.size() - 1);
  }
  std::uint32_t smaller(std::uint32_t n) {
    out_.size[n] = std::min(out_.size[n], size_);
    return n;
  }

  /// Lattice edges of the polygon's vertices, in order; its normal is towards positive values.
  std::size_t polygon(std::size_t piece, std::array<std::array<std::uint8_t, 2>, 4>& ends) const;

  void single(std::size_t piece);

  /// Triangulates the corners. Starts from a corner determined by the lattice, so that adjacent sheets are divided in
  /// the same way.
  void emit(std::size_t piece);

  // ---- Several pieces -------------------------------------------------------------------------------------------

  struct Corner {
    std::uint8_t a, b;  ///< two planes besides that of the piece, in ascending order
  };
  static Corner corner_of(const PieceCell<Mask>& cell, std::size_t i) {
    const std::uint8_t p = cell.edge[(i + cell.edge.size() - 1) % cell.edge.size()], q = cell.edge[i];
    return {std::min(p, q), std::max(p, q)};
  }

  /// Weights (up to a common factor) of the simplex's vertices at a corner of piece h, without their sign.
  std::array<WideInt, 4> weights(std::size_t h, const Corner& c) const;
  WideInt minor(std::size_t g, std::size_t h, std::size_t i, std::size_t j) const {
    return static_cast<WideInt>(value(g, i)) * value(h, j) - static_cast<WideInt>(value(g, j)) * value(h, i);
  }
  static std::array<std::size_t, 2> edge_without(std::size_t a, std::size_t b);
  static std::array<std::size_t, 3> face_without(std::size_t a);

  int weighted(std::size_t g, const std::array<WideInt, 4>& w) const;

  /// The sign of piece g at a corner of piece h. Where it is 0, all pieces are infinitesimally larger, those of higher
  /// index by a larger order (edelsbrunner1990, simulation of simplicity).
  int sign_at(std::size_t g, std::size_t h, const Corner& c) const;

  bool inside(const Mask& negative);
  /// Whether the piece is the surface where the others have these signs.
  bool is_surface(std::size_t piece, Mask negative);
  /// Whether it may be the surface if only the signs in `known` are decided: the inside only grows with the negative
  /// set.
  bool may_be_surface(std::size_t piece, const Mask& negative, const Mask& known);

  std::uint32_t corner_number(std::size_t h, const Corner& c, bool shared);

  void several();

  /// As division by each of the others, but ordered so that few cells remain early.
  void divide_by_many(std::size_t h);

  PieceCell<Mask> first_cell(std::size_t h) const;

  void divide(std::size_t h, std::size_t g);

  /// Whether a corner in a face of the simplex is a surface corner seen from both sides of the face; false where a
  /// plane crosses the face without being surface there. `negative`: mask of an adjacent cell.
  bool shared_corner(std::size_t h, const Corner& c, Mask negative);

  /// Triangulates the remaining cells.
  void surface(std::size_t h);

  const PieceExpression& field_;
  const PieceBlocks& blocks_;
  double quantum_, largest_;  ///< unit and upper limit of values
  const PlainPattern& plain_;
  CutChunk& out_;
  /// Expressions of the block and of the simplex; pieces are indices into `pieces_`.
  std::vector<PieceNode> nodes_, left_;
  std::vector<std::uint32_t> pieces_;
  std::vector<std::int64_t> values_;  ///< by piece and slot
  std::vector<double> found_;
  std::vector<Mask> negative_;  ///< negative pieces, per slot
  std::size_t slots_ = 0;
  std::span<const Vec3> x_;
  std::span<const std::uint32_t> numbers_;
  std::array<std::uint8_t, 4> tet_{};
  std::uint32_t id_ = 0;
  float size_ = 0;
  std::vector<std::uint32_t> corners_;
  CellPolygons polygons_;
  std::vector<Vec3> around_;
  std::vector<std::array<std::uint32_t, 3>> parts_;
  std::vector<std::size_t> used_, order_;
  std::vector<PieceCell<Mask>> cells_;
  std::vector<int> signs_;
  std::vector<std::uint8_t> state_;
};

}  // namespace sansmesh::inline v1
