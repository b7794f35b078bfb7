// PieceCutter: blocks, cells, and simplices with one piece.
#pragma once

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "sansmesh/error.h"
#include "sansmesh/polygonize/pieces/piece_cutter.h"

namespace sansmesh::inline v1 {

/// Two sheets closer than this fraction of the block's edge are two sides of a thin part if the sum of their values
/// changes by at most the second fraction within a cell: for perpendicular sheets it changes by at least 0.7 of that
/// edge.
constexpr double kOtherSide = 0.6, kOtherSideTurns = 0.5;
/// Cosine between two sheets below which they are back to back, or face to face.
constexpr double kFacing = -0.8;

constexpr std::array<std::array<std::uint8_t, 4>, 4> kLoneFirst{
    {{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 1, 0}}};
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

template <std::size_t Bits>
CellStates PieceCutter<Bits>::look(std::size_t leaf, const BlockPattern& pattern, std::span<const Vec3> x) {
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

template <std::size_t Bits>
bool PieceCutter<Bits>::cut(std::size_t leaf, const BlockPattern& pattern, std::span<const std::uint32_t> numbers,
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

template <std::size_t Bits>
bool PieceCutter<Bits>::load(std::size_t leaf, const BlockPattern& pattern, std::span<const Vec3> x) {
  const PieceBlocks::Leaf& l = blocks_.leaves[leaf];
  nodes_.assign(blocks_.nodes.begin() + l.first, blocks_.nodes.begin() + l.first + l.count);
  pieces_.clear();
  for (PieceNode& n : nodes_) {
    if (n.kind != PieceNode::Kind::piece) continue;
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

template <std::size_t Bits>
void PieceCutter<Bits>::too_steep(const Vec3& x) {
  throw DataError(
      fmt::format("the surface cannot be extracted near ({:.4g}, {:.4g}, {:.4g}): values change faster there "
                  "than distances do, or are not finite",
                  x.x, x.y, x.z));
}

template <std::size_t Bits>
KnownSign PieceCutter<Bits>::reduce(const Mask& all, const Mask& any) {
  left_.clear();
  return prune(
      nodes_, left_,
      [&](std::uint32_t p) { return all[p]   ? KnownSign::inside
                                    : any[p] ? KnownSign::unknown
                                             : KnownSign::outside; },
      [](std::uint32_t p, std::uint32_t q) { return p == q; });
}

template <std::size_t Bits>
CellState PieceCutter<Bits>::look_at(std::size_t cell, std::size_t& piece) {
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

template <std::size_t Bits>
bool PieceCutter<Bits>::has_other_side(std::size_t cell, std::size_t piece, double edge) const {
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

template <std::size_t Bits>
void PieceCutter<Bits>::cut_cell(std::size_t cell, CellStates own, const std::array<CellStates, 6>& beside) {
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

template <std::size_t Bits>
void PieceCutter<Bits>::cut_simplex(const Mask& all, const Mask& any) {
  if (nodes_.size() == 1) return single(0);
  if (reduce(all, any) != KnownSign::unknown) return;
  if (left_.size() == 1) return single(left_[0].a);
  several();
}

template <std::size_t Bits>
std::uint32_t PieceCutter<Bits>::between(std::size_t piece, std::size_t i, std::size_t j) {
  if (numbers_[i] > numbers_[j]) std::swap(i, j);
  const std::array<Vec3, 2> ends{x_[i], x_[j]};
  const std::uint32_t name = field_.same_at(pieces_[piece], ends);
  const std::uint32_t n = out_.names.number({numbers_[i], numbers_[j], kNoName, name, kNoName, kNoName});
  if (n < out_.x.size()) return smaller(n);
  const auto f = static_cast<double>(values_[piece * slots_ + i]), g = static_cast<double>(values_[piece * slots_ + j]);
  const double t = f / (f - g);
  const std::uint32_t added = add(x_[i] * (1 - t) + x_[j] * t);
  out_.room[added] = room_beside(piece, out_.x[added]);
  return added;
}

template <std::size_t Bits>
float PieceCutter<Bits>::room_beside(std::size_t piece, const Vec3& x) const {
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
    if (field_.curvature_bound(pieces_[piece], x, 0) > 0 || field_.curvature_bound(pieces_[q], x, 0) > 0) room = gap;
  }
  return static_cast<float>(room);
}

template <std::size_t Bits>
std::size_t PieceCutter<Bits>::polygon(std::size_t piece, std::array<std::array<std::uint8_t, 2>, 4>& ends) const {
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
  const auto [i, j, k, l] = kLoneFirst[lone];
  if (count == 1) {
    ends = {{{i, j}, {i, k}, {i, l}, {}}};
  } else {
    ends = {{{i, l}, {i, k}, {i, j}, {}}};
  }
  return 3;
}

template <std::size_t Bits>
void PieceCutter<Bits>::single(std::size_t piece) {
  std::array<std::array<std::uint8_t, 2>, 4> ends;
  const std::size_t n = polygon(piece, ends);
  corners_.clear();
  for (std::size_t k = 0; k < n; ++k) corners_.push_back(on_edge(piece, ends[k][0], ends[k][1]));
  emit(piece);
}

template <std::size_t Bits>
void PieceCutter<Bits>::emit(std::size_t piece) {
  const std::size_t n = corners_.size();
  std::size_t first = 0;
  if (n > 3)
    for (std::size_t k = 1; k < n; ++k) {
      const CutName &a = out_.names.names()[corners_[k]], &b = out_.names.names()[corners_[first]];
      if (std::pair(a[0], a[1]) < std::pair(b[0], b[1])) first = k;
    }
  for (std::size_t k = 1; k + 1 < n; ++k) {
    out_.triangles.push_back({corners_[first], corners_[(first + k) % n], corners_[(first + k + 1) % n]});
    out_.piece.push_back(pieces_[piece]);
  }
}

}  // namespace sansmesh::inline v1
