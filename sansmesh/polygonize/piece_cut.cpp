#include "sansmesh/polygonize/piece_cut.h"

#include <fmt/core.h>

#include <algorithm>
#include <bitset>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/polygonize/cell_polygons.h"
#include "sansmesh/polygonize/lattice.h"

namespace sansmesh::inline v1 {
namespace {

using Wide = __int128;
using NodeKind = PieceNode::Kind;

constexpr std::uint32_t kNobody = CutPieces::kNone;
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
/// With more pieces than this in a simplex, pieces with neighbouring indices divide first, because they are often
/// adjacent; parts that can no longer be surface are dropped in between, whenever the number of processed pieces
/// doubles.
constexpr std::size_t kDivideAll = 12;
constexpr std::size_t kChunkOfLeaves = 512;
/// Least distance of lattice vertices from the surface, as a fraction of the smallest block's edge; they move by up to
/// twice that.
constexpr double kStandBack = 0.08;
/// Two sheets closer than this fraction of the block's edge are two sides of a thin part if the sum of their values
/// changes by at most the second fraction within a cell: for perpendicular sheets it changes by at least 0.7 of that
/// edge.
constexpr double kOtherSide = 0.6, kOtherSideTurns = 0.5;
/// Cosine between two sheets below which they are back to back, or face to face.
constexpr double kFacing = -0.8;

/// Identifies a vertex in all simplices that share it: on a lattice edge by its ends and the piece; in a face by its
/// corners and two pieces; inside a simplex by the simplex and the pieces.
using Name = std::array<std::uint32_t, 6>;

/// Maps names to indices in order of first use.
class NameTable {
 public:
  std::uint32_t number(const Name& name) {
    if (2 * names_.size() >= table_.size()) grow();
    std::size_t at = scattered(name) & (table_.size() - 1);
    while (table_[at] != kNobody && names_[table_[at]] != name) at = (at + 1) & (table_.size() - 1);
    if (table_[at] == kNobody) {
      table_[at] = static_cast<std::uint32_t>(names_.size());
      names_.push_back(name);
    }
    return table_[at];
  }
  const std::vector<Name>& names() const { return names_; }

 private:
  static std::size_t scattered(const Name& name) {
    std::uint64_t h = 0;
    for (const std::uint32_t k : name) h = (h ^ h >> 29 ^ k) * 0x9e3779b97f4a7c15u;
    return static_cast<std::size_t>(h ^ h >> 32);
  }
  void grow() {
    table_.assign(std::max<std::size_t>(64, 2 * table_.size()), kNobody);
    for (std::uint32_t i = 0; i < names_.size(); ++i) {
      std::size_t at = scattered(names_[i]) & (table_.size() - 1);
      while (table_[at] != kNobody) at = (at + 1) & (table_.size() - 1);
      table_[at] = i;
    }
  }
  std::vector<std::uint32_t> table_;
  std::vector<Name> names_;
};

int sign_of(Wide v) { return v > 0 ? 1 : v < 0 ? -1 : 0; }

/// The sign of Σ weight[i] value[i], with weights of up to kWeightBits and values of kValueBits.
int sign_of_sum(const std::array<Wide, 4>& weight, const std::array<std::int64_t, 4>& value) {
  Wide high = 0, low = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    high += (weight[i] >> 64) * value[i];
    low += static_cast<Wide>(static_cast<std::uint64_t>(weight[i])) * value[i];
  }
  high += low >> 64;
  return high != 0 ? sign_of(high) : static_cast<std::uint64_t>(low) != 0 ? 1 : 0;
}

struct ChunkOfCuts {
  NameTable names;
  std::vector<Vec3> x;
  std::vector<float> size, room;
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> piece;
  std::optional<Vec3> cracked;
};

/// A polygon in the plane of a piece, given by the planes of its edges; vertex i is between edges i − 1 and i. Planes 0
/// to 3 are the faces of the simplex opposite to its vertices, followed by pieces.
template <class Mask>
struct Cell {
  std::vector<std::uint8_t> edge;
  Mask negative;  ///< pieces that are negative in it
};

constexpr std::array<std::array<std::uint8_t, 4>, 4> kLone{{{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 1, 0}}};
/// Even permutation for a set of two negative vertices, which come first.
constexpr std::array<std::uint8_t, 4> two_and_two(unsigned negative) {
  switch (negative) {
    case 0b0011:
      return {0, 1, 2, 3};
    case 0b0101:
      return {0, 2, 3, 1};
    case 0b1001:
      return {0, 3, 1, 2};
    case 0b1100:
      return {2, 3, 0, 1};
    case 0b1010:
      return {3, 1, 0, 2};
    default:
      return {1, 2, 0, 3};
  }
}

/// Surface in a cell (an eighth of a block): none, a single piece, or several pieces.
enum class CellState : std::uint8_t { empty, single, several };
/// For all cells of a block, two bits each.
using CellStates = std::uint16_t;
constexpr CellStates kAllSeveral = 0xaaaa;
CellState state_of(CellStates all, std::size_t cell) { return static_cast<CellState>(all >> (2 * cell) & 3u); }

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
class Cutter {
 public:
  using Mask = std::bitset<Bits>;
  Cutter(const PieceExpression& field, const PieceBlocks& blocks, double quantum, const PlainPattern& plain,
         ChunkOfCuts& out)
      : field_(field),
        blocks_(blocks),
        quantum_(quantum),
        largest_(quantum * (0x1p-1 * (std::int64_t{1} << kValueBits) - 1)),
        plain_(plain),
        out_(out) {}

  /// State of the cells of a block.
  CellStates look(std::size_t leaf, const BlockPattern& pattern, std::span<const Vec3> x) {
    if (&pattern != plain_.pattern) return kAllSeveral;
    if (!load(leaf, pattern, x)) return kAllSeveral;
    CellStates states = 0;
    std::size_t piece = 0;
    const double edge = blocks_.tree.block_edge(blocks_.leaves[leaf].block);
    for (std::size_t cell = 0; cell < 8; ++cell) {
      CellState state = look_at(cell, piece);
      if (state == CellState::single && has_other_side(cell, piece, edge)) state = CellState::several;
      states |= static_cast<CellStates>(static_cast<unsigned>(state) << (2 * cell));
    }
    return states;
  }

  /// `beside`: the cells of the blocks that share a face (2·axis + side). Returns false, without effect, if the block
  /// has too many pieces.
  bool cut(std::size_t leaf, const BlockPattern& pattern, std::span<const std::uint32_t> numbers,
           std::span<const Vec3> x, CellStates own, const std::array<CellStates, 6>& beside) {
    if (own == 0) return true;
    if (!load(leaf, pattern, x)) return false;
    x_ = x, numbers_ = numbers;
    size_ = static_cast<float>(blocks_.tree.block_edge(blocks_.leaves[leaf].block));
    const bool plain = &pattern == plain_.pattern;
    if (plain)
      for (std::size_t cell = 0; cell < 8; ++cell)
        if (state_of(own, cell) == CellState::single) cut_cell(cell, own, beside);
    for (std::size_t t = 0; t < pattern.tets.size(); ++t) {
      if (plain && state_of(own, plain_.cell_of_tet[t]) != CellState::several) continue;
      tet_ = pattern.tets[t];
      const Mask &a = negative_[tet_[0]], &b = negative_[tet_[1]], &c = negative_[tet_[2]], &d = negative_[tet_[3]];
      const Mask all = a & b & c & d, any = a | b | c | d;
      if (all == any) continue;
      id_ = static_cast<std::uint32_t>(leaf * 256 + t);
      cut_simplex(all, any);
    }
    return true;
  }

 private:
  /// Loads nodes, pieces and values of a block; false if there are too many pieces.
  bool load(std::size_t leaf, const BlockPattern& pattern, std::span<const Vec3> x) {
    const PieceBlocks::Leaf& l = blocks_.leaves[leaf];
    nodes_.assign(blocks_.nodes.begin() + l.first, blocks_.nodes.begin() + l.first + l.count);
    pieces_.clear();
    for (PieceNode& n : nodes_) {
      if (n.kind != NodeKind::piece) continue;
      const auto at = std::find(pieces_.begin(), pieces_.end(), n.a);
      if (at == pieces_.end()) {
        pieces_.push_back(n.a);
        n.a = static_cast<std::uint32_t>(pieces_.size() - 1);
      } else {
        n.a = static_cast<std::uint32_t>(at - pieces_.begin());
      }
    }
    if (pieces_.size() >= Bits) return false;
    slots_ = pattern.slots.size();
    values_.resize(pieces_.size() * slots_);
    found_.resize(slots_);
    negative_.assign(slots_, {});
    for (std::size_t p = 0; p < pieces_.size(); ++p) {
      field_.evaluate_piece(pieces_[p], x, found_, {});
      for (std::size_t s = 0; s < slots_; ++s) {
        if (!(std::abs(found_[s]) < largest_)) too_steep(x[s]);
        // Odd, so never 0.
        const std::int64_t v = 2 * static_cast<std::int64_t>(std::floor(found_[s] / quantum_)) + 1;
        values_[p * slots_ + s] = v;
        if (v < 0) negative_[s].set(p);
      }
    }
    return true;
  }

  [[noreturn]] static void too_steep(const Vec3& x) {
    throw DataError(
        fmt::format("the surface cannot be extracted near ({:.4g}, {:.4g}, {:.4g}): values change faster there "
                    "than distances do, or are not finite",
                    x.x, x.y, x.z));
  }

  /// Reduces the expression, given the pieces that are negative at all or at any corners.
  KnownSign reduce(const Mask& all, const Mask& any) {
    left_.clear();
    return prune(
        nodes_, left_,
        [&](std::uint32_t p) { return all[p]   ? KnownSign::inside
                                      : any[p] ? KnownSign::unknown
                                               : KnownSign::outside; },
        [](std::uint32_t p, std::uint32_t q) { return p == q; });
  }

  CellState look_at(std::size_t cell, std::size_t& piece) {
    Mask all, any;
    all.set();
    for (std::size_t c = 0; c < 8; ++c) {
      const Mask& here = negative_[plain_.corner(cell, c)];
      all &= here, any |= here;
    }
    if (nodes_.size() == 1) {
      piece = 0;
      return all == any ? CellState::empty : CellState::single;
    }
    if (reduce(all, any) != KnownSign::unknown) return CellState::empty;
    if (left_.size() > 1) return CellState::several;
    piece = left_[0].a;
    return CellState::single;
  }

  /// Whether another sheet is close by and face to face or back to back with the piece's: simplices then divide both in
  /// the same way, so that the part between keeps its thickness.
  bool has_other_side(std::size_t cell, std::size_t piece, double edge) const {
    for (std::size_t q = 0; q < pieces_.size(); ++q) {
      if (q == piece) continue;
      double least = std::numeric_limits<double>::infinity(), most = -least;
      for (std::size_t c = 0; c < 8; ++c) {
        const std::size_t s = plain_.corner(cell, c);
        const double sum = quantum_ / 2 * static_cast<double>(values_[piece * slots_ + s] + values_[q * slots_ + s]);
        least = std::min(least, sum), most = std::max(most, sum);
      }
      if (most - least <= kOtherSideTurns * edge && std::max(-least, most) <= kOtherSide * edge) return true;
    }
    return false;
  }

  /// A cell with one piece: simplices are needed only at faces shared with cells that use them.
  void cut_cell(std::size_t cell, CellStates own, const std::array<CellStates, 6>& beside) {
    std::size_t piece = 0;
    look_at(cell, piece);
    unsigned negative = 0, split = 0;
    for (std::size_t c = 0; c < 8; ++c)
      if (negative_[plain_.corner(cell, c)][piece]) negative |= 1u << c;
    for (std::size_t face = 0; face < 6; ++face) {
      const std::size_t axis = face / 2, side = face % 2, other = cell ^ std::size_t{1} << axis;
      const CellStates there = side == (cell >> axis & 1u) ? beside[face] : own;
      if (state_of(there, other) == CellState::several) split |= 1u << face;
    }
    trace_cell(negative, cell, split, polygons_);
    std::size_t first = 0;
    for (const std::size_t end : polygons_.ends) {
      corners_.clear();
      around_.clear();
      for (std::size_t k = first; k < end; ++k) {
        const auto [a, b] = polygons_.points[k];
        corners_.push_back(between(piece, plain_.corner(cell, a), plain_.corner(cell, b)));
        around_.push_back(out_.x[corners_.back()]);
      }
      first = end;
      best_triangles(around_, parts_);
      for (const auto& [a, b, c] : parts_) {
        out_.triangles.push_back({corners_[a], corners_[b], corners_[c]});
        out_.piece.push_back(pieces_[piece]);
      }
    }
  }

  /// Index of a constant 1 in place of a piece.
  static constexpr std::size_t kOnes = Bits - 1;
  std::int64_t value(std::size_t piece, std::size_t corner) const {
    return piece == kOnes ? 1 : values_[piece * slots_ + tet_[corner]];
  }

  void cut_simplex(const Mask& all, const Mask& any) {
    if (nodes_.size() == 1) return single(0);
    if (reduce(all, any) != KnownSign::unknown) return;
    if (left_.size() == 1) return single(left_[0].a);
    several();
  }

  // ---- One piece ------------------------------------------------------------------------------------------------

  std::uint32_t on_edge(std::size_t piece, std::size_t i, std::size_t j) { return between(piece, tet_[i], tet_[j]); }

  /// Vertex where the piece vanishes between two slots.
  std::uint32_t between(std::size_t piece, std::size_t i, std::size_t j) {
    if (numbers_[i] > numbers_[j]) std::swap(i, j);
    const std::array<Vec3, 2> ends{x_[i], x_[j]};
    const std::uint32_t name = field_.same_at(pieces_[piece], ends);
    const std::uint32_t n = out_.names.number({numbers_[i], numbers_[j], kNobody, name, kNobody, kNobody});
    if (n < out_.x.size()) return smaller(n);
    const auto f = static_cast<double>(values_[piece * slots_ + i]),
               g = static_cast<double>(values_[piece * slots_ + j]);
    const double t = f / (f - g);
    const std::uint32_t added = add(x_[i] * (1 - t) + x_[j] * t);
    out_.room[added] = room_beside(piece, out_.x[added]);
    return added;
  }

  /// Distance of a point of a piece from sheets back to back with it, or face to face.
  float room_beside(std::size_t piece, const Vec3& x) const {
    double room = std::numeric_limits<double>::infinity();
    if (pieces_.size() < 2) return static_cast<float>(room);
    double own = 0, value = 0;
    Vec3 normal, other;
    field_.evaluate_piece(pieces_[piece], {&x, 1}, {&own, 1}, {&normal, 1});
    for (std::size_t q = 0; q < pieces_.size(); ++q) {
      if (q == piece) continue;
      field_.evaluate_piece(pieces_[q], {&x, 1}, {&value, 1}, {&other, 1});
      // The point is not exactly on its piece yet: the sum of both values is the thickness. Two flat sheets stay apart
      // with any triangles.
      const double gap = std::abs(own + value);
      if (gap >= room || dot(normal, other) > kFacing * norm(normal) * norm(other)) continue;
      if (field_.bend(pieces_[piece], x, 0) > 0 || field_.bend(pieces_[q], x, 0) > 0) room = gap;
    }
    return static_cast<float>(room);
  }

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
  std::size_t polygon(std::size_t piece, std::array<std::array<std::uint8_t, 2>, 4>& ends) const {
    unsigned negative = 0;
    int count = 0;
    for (std::size_t k = 0; k < 4; ++k)
      if (value(piece, k) < 0) negative |= 1u << k, ++count;
    if (count == 2) {
      const auto [i, j, k, l] = two_and_two(negative);
      ends = {{{i, k}, {i, l}, {j, l}, {j, k}}};
      return 4;
    }
    std::size_t lone = 0;
    while (((negative >> lone & 1u) != 0) != (count == 1)) ++lone;
    const auto [i, j, k, l] = kLone[lone];
    if (count == 1) {
      ends = {{{i, j}, {i, k}, {i, l}, {}}};
    } else {
      ends = {{{i, l}, {i, k}, {i, j}, {}}};
    }
    return 3;
  }

  void single(std::size_t piece) {
    std::array<std::array<std::uint8_t, 2>, 4> ends;
    const std::size_t n = polygon(piece, ends);
    corners_.clear();
    for (std::size_t k = 0; k < n; ++k) corners_.push_back(on_edge(piece, ends[k][0], ends[k][1]));
    emit(piece);
  }

  /// Triangulates the corners. Starts from a corner determined by the lattice, so that adjacent sheets are divided in
  /// the same way.
  void emit(std::size_t piece) {
    const std::size_t n = corners_.size();
    std::size_t first = 0;
    if (n > 3)
      for (std::size_t k = 1; k < n; ++k) {
        const Name &a = out_.names.names()[corners_[k]], &b = out_.names.names()[corners_[first]];
        if (std::pair(a[0], a[1]) < std::pair(b[0], b[1])) first = k;
      }
    for (std::size_t k = 1; k + 1 < n; ++k) {
      out_.triangles.push_back({corners_[first], corners_[(first + k) % n], corners_[(first + k + 1) % n]});
      out_.piece.push_back(pieces_[piece]);
    }
  }

  // ---- Several pieces -------------------------------------------------------------------------------------------

  struct Corner {
    std::uint8_t a, b;  ///< two planes besides that of the piece, in ascending order
  };
  static Corner corner_of(const Cell<Mask>& cell, std::size_t i) {
    const std::uint8_t p = cell.edge[(i + cell.edge.size() - 1) % cell.edge.size()], q = cell.edge[i];
    return {std::min(p, q), std::max(p, q)};
  }

  /// Weights (up to a common factor) of the simplex's vertices at a corner of piece h, without their sign.
  std::array<Wide, 4> weights(std::size_t h, const Corner& c) const {
    std::array<Wide, 4> w{};
    if (c.b < 4) {
      const std::array<std::size_t, 2> e = edge_without(c.a, c.b);
      w[e[0]] = value(h, e[1]), w[e[1]] = -static_cast<Wide>(value(h, e[0]));
      return w;
    }
    if (c.a < 4) {
      const std::array<std::size_t, 3> f = face_without(c.a);
      const std::size_t g = c.b - 4u;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = f[(k + 1) % 3], j = f[(k + 2) % 3];
        w[f[k]] = minor(h, g, i, j);
      }
      return w;
    }
    const std::size_t g = c.a - 4u, k = c.b - 4u;
    for (std::size_t v = 0; v < 4; ++v) {
      const std::array<std::size_t, 3> f = face_without(v);
      const Wide d = minor(g, k, f[1], f[2]) * value(h, f[0]) - minor(g, k, f[0], f[2]) * value(h, f[1]) +
                     minor(g, k, f[0], f[1]) * value(h, f[2]);
      w[v] = v % 2 ? -d : d;
    }
    return w;
  }
  Wide minor(std::size_t g, std::size_t h, std::size_t i, std::size_t j) const {
    return static_cast<Wide>(value(g, i)) * value(h, j) - static_cast<Wide>(value(g, j)) * value(h, i);
  }
  static std::array<std::size_t, 2> edge_without(std::size_t a, std::size_t b) {
    std::array<std::size_t, 2> e{};
    for (std::size_t k = 0, n = 0; k < 4; ++k)
      if (k != a && k != b) e[n++] = k;
    return e;
  }
  static std::array<std::size_t, 3> face_without(std::size_t a) {
    std::array<std::size_t, 3> f{};
    for (std::size_t k = 0, n = 0; k < 4; ++k)
      if (k != a) f[n++] = k;
    return f;
  }

  int weighted(std::size_t g, const std::array<Wide, 4>& w) const {
    return sign_of_sum(w, {value(g, 0), value(g, 1), value(g, 2), value(g, 3)});
  }

  /// The sign of piece g at a corner of piece h. Where it is 0, all pieces are infinitesimally larger, those of higher
  /// index by a larger order (edelsbrunner1990, simulation of simplicity).
  int sign_at(std::size_t g, std::size_t h, const Corner& c) const {
    const std::array<Wide, 4> w = weights(h, c);
    const int all = sign_of(w[0] + w[1] + w[2] + w[3]);
    if (const int s = all * weighted(g, w); s != 0) return s;
    struct Part {
      std::uint32_t piece;
      int sign;
    };
    std::array<Part, 4> part{};
    std::size_t n = 0;
    part[n++] = {pieces_[g], all};
    part[n++] = {pieces_[h], weighted(g, weights(kOnes, c))};
    constexpr auto kPlaneOfOnes = static_cast<std::uint8_t>(4 + kOnes);
    if (c.b >= 4) part[n++] = {pieces_[c.b - 4u], weighted(g, weights(h, {c.a, kPlaneOfOnes}))};
    if (c.a >= 4) part[n++] = {pieces_[c.a - 4u], weighted(g, weights(h, {kPlaneOfOnes, c.b}))};
    std::sort(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(n),
              [](const Part& a, const Part& b) { return a.piece > b.piece; });
    for (std::size_t k = 0; k < n; ++k)
      if (part[k].sign != 0) return all * part[k].sign;
    return 1;
  }

  bool inside(const Mask& negative) {
    state_.resize(left_.size());
    for (std::size_t k = 0; k < left_.size(); ++k) {
      const PieceNode& n = left_[k];
      state_[k] = n.kind == NodeKind::piece   ? negative[n.a]
                  : n.kind == NodeKind::least ? state_[n.a] || state_[n.b]
                                              : state_[n.a] && state_[n.b];
    }
    return state_.back();
  }
  /// Whether the piece is the surface where the others have these signs.
  bool is_surface(std::size_t piece, Mask negative) {
    return inside(negative.set(piece)) && !inside(negative.reset(piece));
  }
  /// Whether it may be the surface if only the signs in `known` are decided: the inside only grows with the negative
  /// set.
  bool may_be_surface(std::size_t piece, const Mask& negative, const Mask& known) {
    Mask most = negative | ~known, least = negative & known;
    return inside(most.set(piece)) && !inside(least.reset(piece));
  }

  std::uint32_t corner_number(std::size_t h, const Corner& c, bool shared) {
    if (c.b < 4) {
      const std::array<std::size_t, 2> e = edge_without(c.a, c.b);
      return on_edge(h, e[0], e[1]);
    }
    Name name{kNobody, kNobody, kNobody, kNobody, kNobody, kNobody};
    std::array<std::uint32_t, 3> p{pieces_[h], pieces_[c.b - 4u], c.a < 4 ? kNobody : pieces_[c.a - 4u]};
    if (c.a < 4 && shared) {
      const std::array<std::size_t, 3> f = face_without(c.a);
      const std::array<Vec3, 3> corners{x_[tet_[f[0]]], x_[tet_[f[1]]], x_[tet_[f[2]]]};
      for (std::size_t k = 0; k < 2; ++k) p[k] = field_.same_at(p[k], corners);
    }
    std::sort(p.begin(), p.end());
    if (c.a < 4 && shared) {
      const std::array<std::size_t, 3> f = face_without(c.a);
      std::array<std::uint32_t, 3> v{numbers_[tet_[f[0]]], numbers_[tet_[f[1]]], numbers_[tet_[f[2]]]};
      std::sort(v.begin(), v.end());
      name = {v[0], v[1], v[2], p[0], p[1], kNobody};
    } else if (c.a < 4) {
      name = {kNobody, id_, c.a, p[0], p[1], pieces_[h]};  // one for each of its pieces
    } else {
      name = {kNobody, id_, kNobody, p[0], p[1], p[2]};
    }
    const std::uint32_t n = out_.names.number(name);
    if (n < out_.x.size()) return smaller(n);
    const std::array<Wide, 4> w = weights(h, c);
    double sum = 0;
    Vec3 x;
    for (std::size_t k = 0; k < 4; ++k) {
      const double weight = std::abs(static_cast<double>(w[k]));
      sum += weight;
      x += x_[tet_[k]] * weight;
    }
    return add(x / sum);
  }

  void several() {
    used_.clear();
    for (const PieceNode& n : left_)
      if (n.kind == NodeKind::piece && std::find(used_.begin(), used_.end(), n.a) == used_.end()) used_.push_back(n.a);
    for (const std::size_t h : used_) {
      cells_.clear();
      cells_.push_back(first_cell(h));
      if (used_.size() > kDivideAll) {
        divide_by_many(h);
      } else {
        for (const std::size_t g : used_)
          if (g != h) divide(h, g);
      }
      std::erase_if(cells_, [&](const Cell<Mask>& c) { return !is_surface(h, c.negative); });
      surface(h);
    }
  }

  /// As division by each of the others, but ordered so that few cells remain early.
  void divide_by_many(std::size_t h) {
    order_ = used_;
    const auto apart = [&](std::size_t g) { return g > h ? 2 * (g - h) : 2 * (h - g) + 1; };
    std::sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) { return apart(a) < apart(b); });
    Mask known;
    std::size_t looked_at = 2;
    for (std::size_t k = 0; k < order_.size() && !cells_.empty(); ++k) {
      if (order_[k] == h) continue;
      divide(h, order_[k]);
      known.set(order_[k]);
      if (k < looked_at) continue;
      looked_at *= 2;
      std::erase_if(cells_, [&](const Cell<Mask>& c) { return !may_be_surface(h, c.negative, known); });
    }
  }

  Cell<Mask> first_cell(std::size_t h) const {
    std::array<std::array<std::uint8_t, 2>, 4> ends;
    const std::size_t n = polygon(h, ends);
    Cell<Mask> cell;
    for (std::size_t k = 0; k < n; ++k) {
      const auto &a = ends[k], &b = ends[(k + 1) % n];
      std::uint8_t plane = 0;  // face of both edges: opposite to the vertex that neither has
      while (plane == a[0] || plane == a[1] || plane == b[0] || plane == b[1]) ++plane;
      cell.edge.push_back(plane);
    }
    return cell;
  }

  void divide(std::size_t h, std::size_t g) {
    const auto plane = static_cast<std::uint8_t>(4 + g);
    for (std::size_t c = 0, count = cells_.size(); c < count; ++c) {
      const std::size_t n = cells_[c].edge.size();
      signs_.resize(n);
      int negative = 0;
      for (std::size_t i = 0; i < n; ++i) {
        signs_[i] = sign_at(g, h, corner_of(cells_[c], i));
        negative += signs_[i] < 0;
      }
      if (negative == 0) continue;
      if (negative == static_cast<int>(n)) {
        cells_[c].negative.set(g);
        continue;
      }
      Cell<Mask> below{{}, cells_[c].negative}, above{{}, cells_[c].negative};
      below.negative.set(g);
      for (std::size_t i = 0; i < n; ++i) {
        const int here = signs_[i], next = signs_[(i + 1) % n];
        for (Cell<Mask>* part : {&below, &above}) {
          const int side = part == &below ? -1 : 1;
          if (here == side || next == side) part->edge.push_back(cells_[c].edge[i]);
          if (here == side && next != side) part->edge.push_back(plane);
        }
      }
      cells_[c] = std::move(below);
      cells_.push_back(std::move(above));
    }
  }

  /// Whether a corner in a face of the simplex is a surface corner seen from both sides of the face; false where a
  /// plane crosses the face without being surface there. `negative`: mask of an adjacent cell.
  bool shared_corner(std::size_t h, const Corner& c, Mask negative) {
    return c.b < 4 || c.a >= 4 || !is_surface(h, negative.flip(c.b - 4u));
  }

  /// Triangulates the remaining cells.
  void surface(std::size_t h) {
    struct Side {  // along a face
      std::uint32_t from, to;
      std::uint8_t face;
      bool from_shared, to_shared;
    };
    std::vector<Side> sides;
    bool odd = false;
    for (const Cell<Mask>& cell : cells_) {
      const std::size_t n = cell.edge.size();
      std::vector<std::uint32_t> number(n);
      std::vector<std::uint8_t> shared(n);
      for (std::size_t i = 0; i < n; ++i) {
        const Corner c = corner_of(cell, i);
        shared[i] = shared_corner(h, c, cell.negative);
        odd = odd || !shared[i];
        number[i] = corner_number(h, c, shared[i] != 0);
      }
      corners_ = number;
      emit(h);
      for (std::size_t i = 0; i < n; ++i)
        if (cell.edge[i] < 4)
          sides.push_back({number[i], number[(i + 1) % n], cell.edge[i], shared[i] != 0, shared[(i + 1) % n] != 0});
    }
    if (!odd) return;
    // Seen from the other side of a face, several sides may be one: the region between is a polygon without area.
    std::vector<Side> next_of = sides;
    const auto before = [](const Side& a, const Side& b) {
      return std::pair(a.face, a.from) < std::pair(b.face, b.from);
    };
    std::stable_sort(next_of.begin(), next_of.end(), before);
    for (const Side& first : sides) {
      if (!first.from_shared || first.to_shared) continue;
      std::vector<std::uint32_t> chain{first.from, first.to};
      bool ended = false;
      while (!ended && chain.size() <= sides.size()) {
        const Side end{chain.back(), 0, first.face, false, false};
        const auto next = std::lower_bound(next_of.begin(), next_of.end(), end, before);
        if (next == next_of.end() || before(end, *next)) break;
        chain.push_back(next->to);
        ended = next->to_shared;
      }
      if (!ended && !out_.cracked) out_.cracked = out_.x[first.from];
      // From its beginning straight to the end, and back along the sides.
      for (std::size_t k = chain.size() - 1; k >= 2; --k) {
        out_.triangles.push_back({chain[0], chain[k], chain[k - 1]});
        out_.piece.push_back(pieces_[h]);
      }
    }
  }

  const PieceExpression& field_;
  const PieceBlocks& blocks_;
  double quantum_, largest_;  ///< unit and upper limit of values
  const PlainPattern& plain_;
  ChunkOfCuts& out_;
  std::vector<PieceNode> nodes_,
      left_;  ///< expressions of the block and of the simplex; pieces are indices into `pieces_`
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
  std::vector<Cell<Mask>> cells_;
  std::vector<int> signs_;
  std::vector<std::uint8_t> state_;
};

/// New position of a lattice vertex that is closer to a sheet than `least`, or between two sheets closer to each other
/// than that: moved along the normal until all of them are on one side.
Vec3 stand_back(const PieceExpression& field, std::span<const PieceNode> nodes, const Vec3& x, double least) {
  struct Sheet {
    double value;
    Vec3 gradient;
  };
  thread_local std::vector<Sheet> near;
  near.clear();
  for (const PieceNode& n : nodes) {
    if (n.kind != NodeKind::piece) continue;
    Sheet s{};
    field.evaluate_piece(n.a, {&x, 1}, {&s.value, 1}, {&s.gradient, 1});
    const double slope = norm(s.gradient);
    if (!(slope > 0.1) || std::abs(s.value) > 2 * least * slope) continue;
    near.push_back({s.value / slope, s.gradient / slope});
  }
  if (near.empty()) return x;
  const auto nearest = std::min_element(
      near.begin(), near.end(), [](const Sheet& a, const Sheet& b) { return std::abs(a.value) < std::abs(b.value); });
  if (std::abs(nearest->value) >= least) return x;
  const Vec3 normal = nearest->gradient;
  double lowest = 0, highest = 0;
  bool first = true;
  for (const Sheet& s : near) {
    const double along = dot(s.gradient, normal);
    if (std::abs(along) < 0.9) continue;
    const double height = along > 0 ? s.value : -s.value;
    lowest = first ? height : std::min(lowest, height);
    highest = first ? height : std::max(highest, height);
    first = false;
  }
  const double up = least - lowest, down = least + highest;
  const double by = up < down ? up : -down;
  return std::abs(by) <= 2 * least ? x + normal * by : x;
}

/// Positions of the lattice vertices: none so close to a sheet that tiny corners are cut off, and none inside a thin
/// wall, whose two sheets would be divided in different ways.
std::vector<Vec3> lattice_places(const PieceExpression& field, const PieceBlocks& blocks,
                                 const std::vector<std::uint32_t>& numbers, const std::vector<std::size_t>& first,
                                 const std::vector<LatticePoint>& points) {
  const BlockTree& tree = blocks.tree;
  std::vector<std::uint32_t> owner(points.size(), kNobody);
  std::vector<float> edge(points.size(), std::numeric_limits<float>::max());
  for (std::uint32_t i = 0; i < blocks.leaves.size(); ++i) {
    const auto e = static_cast<float>(tree.block_edge(blocks.leaves[i].block));
    for (std::size_t s = first[i]; s < first[i + 1]; ++s) {
      if (owner[numbers[s]] == kNobody) owner[numbers[s]] = i;
      edge[numbers[s]] = std::min(edge[numbers[s]], e);
    }
  }
  const double unit = tree.edge() / static_cast<double>(2u << tree.depth());
  std::vector<Vec3> place(points.size());
  parallel_for(0, points.size(), 1024, [&](std::size_t v) {
    const LatticePoint& p = points[v];
    const Vec3 x =
        tree.lower() + Vec3{static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])} * unit;
    const PieceBlocks::Leaf& leaf = blocks.leaves[owner[v]];
    place[v] = stand_back(field, std::span(blocks.nodes).subspan(leaf.first, leaf.count), x,
                          kStandBack * static_cast<double>(edge[v]));
  });
  return place;
}

/// Distances to other sheets that cross the same lattice edge.
void find_room(CutPieces& cut, const std::vector<Name>& names) {
  std::vector<KeyIndex> on_edges;
  for (std::uint32_t v = 0; v < names.size(); ++v)
    if (names[v][0] != kNobody && names[v][2] == kNobody)
      on_edges.push_back({std::uint64_t{names[v][0]} << 32 | names[v][1], v});
  parallel_sort(on_edges);
  for (std::size_t i = 0, j; i < on_edges.size(); i = j) {
    for (j = i + 1; j < on_edges.size() && on_edges[j].key == on_edges[i].key; ++j) {
    }
    for (std::size_t a = i; a < j; ++a)
      for (std::size_t b = a + 1; b < j; ++b) {
        CutPieces::Vertex &v = cut.vertices[on_edges[a].index], &w = cut.vertices[on_edges[b].index];
        const auto distance = static_cast<float>(norm(v.x - w.x));
        v.room = std::min(v.room, distance);
        w.room = std::min(w.room, distance);
      }
  }
}

}  // namespace

CutPieces cut_pieces(const PieceExpression& field, const PieceBlocks& blocks, Progress& progress) {
  const BlockTree& tree = blocks.tree;
  for (const PieceBlocks::Leaf& l : blocks.leaves) {
    if (distinct_pieces(std::span(blocks.nodes).subspan(l.first, l.count)) <= kMostPiecesInBlock) continue;
    CutPieces none;
    none.crowded = tree.block_center(l.block);
    return none;
  }
  const std::size_t n = blocks.leaves.size(), chunks = (n + kChunkOfLeaves - 1) / kChunkOfLeaves;
  progress.begin("cut", chunks);
  std::vector<BlockRefinement> refinement(n);
  parallel_for(0, n, 1024, [&](std::size_t i) { refinement[i] = refinement_of(tree, blocks.leaves[i].block); });
  PatternTable patterns;
  LatticeNumbering numbering;
  std::vector<const BlockPattern*> pattern(n);
  std::vector<std::size_t> first(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    pattern[i] = &patterns.pattern(refinement[i]);
    first[i + 1] = first[i] + pattern[i]->slots.size();
  }
  std::vector<std::uint32_t> numbers(first[n]);
  for (std::size_t i = 0; i < n; ++i) {
    const BlockTree::Block& b = tree[blocks.leaves[i].block];
    const std::uint32_t edge = 2u << (tree.depth() - b.level);
    for (std::size_t s = 0; s < pattern[i]->slots.size(); ++s) {
      const std::uint32_t slot = pattern[i]->slots[s], q[3] = {slot % 5u, slot / 5u % 5u, slot / 25u};
      numbers[first[i] + s] = numbering.number(
          {b.cell[0] * edge + q[0] * edge / 4, b.cell[1] * edge + q[1] * edge / 4, b.cell[2] * edge + q[2] * edge / 4});
    }
  }
  const std::vector<Vec3> place = lattice_places(field, blocks, numbers, first, numbering.points());
  const double quantum = std::ldexp(blocks.scale, -kValueBits);
  const PlainPattern plain(patterns.pattern({}));
  std::vector<ChunkOfCuts> found(chunks);
  /// Visits the leaves of a chunk with their vertex indices and positions.
  const auto for_leaves = [&](std::size_t c, auto&& leaf) {
    Cutter<kUsualBits> cutter(field, blocks, quantum, plain, found[c]);
    std::vector<Vec3> x;
    for (std::size_t i = c * kChunkOfLeaves; i < std::min(n, (c + 1) * kChunkOfLeaves); ++i) {
      progress.check();
      const std::span<const std::uint32_t> own(numbers.data() + first[i], first[i + 1] - first[i]);
      x.clear();
      for (const std::uint32_t v : own) x.push_back(place[v]);
      leaf(cutter, i, own, x);
    }
  };
  std::vector<CellStates> cells(n);
  parallel_for(0, chunks, 1, [&](std::size_t c) {
    for_leaves(c, [&](Cutter<kUsualBits>& cutter, std::size_t i, std::span<const std::uint32_t>,
                      std::span<const Vec3> x) { cells[i] = cutter.look(i, *pattern[i], x); });
  });
  std::vector<std::uint32_t> leaf_of(tree.size(), kNobody);
  for (std::uint32_t i = 0; i < n; ++i) leaf_of[blocks.leaves[i].block] = i;
  /// Cells of the block beside it: none where there is no surface, all where it has another size.
  const auto cells_beside = [&](std::size_t i, std::size_t face) -> CellStates {
    const BlockTree::Block& b = tree[blocks.leaves[i].block];
    std::array<std::int64_t, 3> at{b.cell[0], b.cell[1], b.cell[2]};
    at[face / 2] += face % 2 ? 1 : -1;
    const std::int64_t other = tree.find(b.level, at[0], at[1], at[2]);
    if (other < 0 || leaf_of[static_cast<std::size_t>(other)] == kNobody) return 0;
    return tree[static_cast<std::size_t>(other)].level == b.level ? cells[leaf_of[static_cast<std::size_t>(other)]]
                                                                  : kAllSeveral;
  };
  parallel_for(0, chunks, 1, [&](std::size_t c) {
    Cutter<kManyBits> cutter_of_many(field, blocks, quantum, plain, found[c]);
    const auto cut = [&](Cutter<kUsualBits>& cutter, std::size_t i, std::span<const std::uint32_t> own,
                         std::span<const Vec3> x) {
      std::array<CellStates, 6> beside{};
      if (pattern[i] == plain.pattern)
        for (std::size_t face = 0; face < 6; ++face) beside[face] = cells_beside(i, face);
      if (!cutter.cut(i, *pattern[i], own, x, cells[i], beside))
        cutter_of_many.cut(i, *pattern[i], own, x, cells[i], beside);
    };
    for_leaves(c, cut);
  });

  CutPieces cut;
  NameTable names;
  for (ChunkOfCuts& c : found) {
    if (!cut.cracked) cut.cracked = c.cracked;
    std::vector<std::uint32_t> number(c.x.size());
    for (std::size_t v = 0; v < c.x.size(); ++v) {
      const Name& name = c.names.names()[v];
      number[v] = names.number(name);
      if (number[v] < cut.vertices.size()) {
        CutPieces::Vertex& old = cut.vertices[number[v]];
        old.size = std::min(old.size, c.size[v]);
        old.room = std::min(old.room, c.room[v]);
        continue;
      }
      CutPieces::Vertex vertex;
      vertex.x = c.x[v];
      vertex.size = c.size[v];
      vertex.room = c.room[v];
      // A corner inside a face that belongs to one simplex alone is only on its piece.
      const bool alone = name[0] == kNobody && name[2] != kNobody;
      vertex.piece = alone ? std::array{name[5], kNobody, kNobody} : std::array{name[3], name[4], name[5]};
      cut.vertices.push_back(vertex);
    }
    for (std::size_t t = 0; t < c.triangles.size(); ++t) {
      const Triangle& old = c.triangles[t];
      cut.triangles.push_back({number[old[0]], number[old[1]], number[old[2]]});
      cut.piece.push_back(c.piece[t]);
    }
    c = {};
    progress.advance();
  }
  find_room(cut, names.names());
  progress.finish();
  return cut;
}

}  // namespace sansmesh::inline v1
