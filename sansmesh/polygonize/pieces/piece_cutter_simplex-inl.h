// PieceCutter: simplices with several pieces.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "sansmesh/polygonize/pieces/piece_cutter.h"

namespace sansmesh::inline v1 {

/// With more pieces than this in a simplex, pieces with neighbouring indices divide first, because they are often
/// adjacent; parts that can no longer be surface are dropped in between, whenever the number of processed pieces
/// doubles.
constexpr std::size_t kDivideAll = 12;

inline int sign_of(WideInt v) { return v > 0 ? 1 : v < 0 ? -1 : 0; }

/// The sign of Σ weight[i] value[i], with weights of up to kWeightBits and values of kValueBits.
inline int sign_of_sum(const std::array<WideInt, 4>& weight, const std::array<std::int64_t, 4>& value) {
  WideInt high = 0, low = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    high += (weight[i] >> 64) * value[i];
    low += static_cast<WideInt>(static_cast<std::uint64_t>(weight[i])) * value[i];
  }
  high += low >> 64;
  return high != 0 ? sign_of(high) : static_cast<std::uint64_t>(low) != 0 ? 1 : 0;
}

template <std::size_t Bits>
std::array<WideInt, 4> PieceCutter<Bits>::weights(std::size_t h, const Corner& c) const {
  std::array<WideInt, 4> w{};
  if (c.b < 4) {
    const std::array<std::size_t, 2> e = edge_without(c.a, c.b);
    w[e[0]] = value(h, e[1]), w[e[1]] = -static_cast<WideInt>(value(h, e[0]));
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
    const WideInt d = minor(g, k, f[1], f[2]) * value(h, f[0]) - minor(g, k, f[0], f[2]) * value(h, f[1]) +
                      minor(g, k, f[0], f[1]) * value(h, f[2]);
    w[v] = v % 2 ? -d : d;
  }
  return w;
}

template <std::size_t Bits>
std::array<std::size_t, 2> PieceCutter<Bits>::edge_without(std::size_t a, std::size_t b) {
  std::array<std::size_t, 2> e{};
  for (std::size_t k = 0, n = 0; k < 4; ++k)
    if (k != a && k != b) e[n++] = k;
  return e;
}

template <std::size_t Bits>
std::array<std::size_t, 3> PieceCutter<Bits>::face_without(std::size_t a) {
  std::array<std::size_t, 3> f{};
  for (std::size_t k = 0, n = 0; k < 4; ++k)
    if (k != a) f[n++] = k;
  return f;
}

template <std::size_t Bits>
int PieceCutter<Bits>::weighted(std::size_t g, const std::array<WideInt, 4>& w) const {
  return sign_of_sum(w, {value(g, 0), value(g, 1), value(g, 2), value(g, 3)});
}

template <std::size_t Bits>
int PieceCutter<Bits>::sign_at(std::size_t g, std::size_t h, const Corner& c) const {
  const std::array<WideInt, 4> w = weights(h, c);
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

template <std::size_t Bits>
bool PieceCutter<Bits>::inside(const Mask& negative) {
  state_.resize(left_.size());
  for (std::size_t k = 0; k < left_.size(); ++k) {
    const PieceNode& n = left_[k];
    state_[k] = n.kind == PieceNode::Kind::piece   ? negative[n.a]
                : n.kind == PieceNode::Kind::least ? state_[n.a] || state_[n.b]
                                                   : state_[n.a] && state_[n.b];
  }
  return state_.back();
}

template <std::size_t Bits>
bool PieceCutter<Bits>::is_surface(std::size_t piece, Mask negative) {
  return inside(negative.set(piece)) && !inside(negative.reset(piece));
}

template <std::size_t Bits>
bool PieceCutter<Bits>::may_be_surface(std::size_t piece, const Mask& negative, const Mask& known) {
  Mask most = negative | ~known, least = negative & known;
  return inside(most.set(piece)) && !inside(least.reset(piece));
}

template <std::size_t Bits>
std::uint32_t PieceCutter<Bits>::corner_number(std::size_t h, const Corner& c, bool shared) {
  if (c.b < 4) {
    const std::array<std::size_t, 2> e = edge_without(c.a, c.b);
    return on_edge(h, e[0], e[1]);
  }
  CutName name{kNoName, kNoName, kNoName, kNoName, kNoName, kNoName};
  std::array<std::uint32_t, 3> p{pieces_[h], pieces_[c.b - 4u], c.a < 4 ? kNoName : pieces_[c.a - 4u]};
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
    name = {v[0], v[1], v[2], p[0], p[1], kNoName};
  } else if (c.a < 4) {
    name = {kNoName, id_, c.a, p[0], p[1], pieces_[h]};  // one for each of its pieces
  } else {
    name = {kNoName, id_, kNoName, p[0], p[1], p[2]};
  }
  const std::uint32_t n = out_.names.number(name);
  if (n < out_.x.size()) return smaller(n);
  const std::array<WideInt, 4> w = weights(h, c);
  double sum = 0;
  Vec3 x;
  for (std::size_t k = 0; k < 4; ++k) {
    const double weight = std::abs(static_cast<double>(w[k]));
    sum += weight;
    x += x_[tet_[k]] * weight;
  }
  return add(x / sum);
}

template <std::size_t Bits>
void PieceCutter<Bits>::several() {
  used_.clear();
  for (const PieceNode& n : left_)
    if (n.kind == PieceNode::Kind::piece && std::find(used_.begin(), used_.end(), n.a) == used_.end())
      used_.push_back(n.a);
  for (const std::size_t h : used_) {
    cells_.clear();
    cells_.push_back(first_cell(h));
    if (used_.size() > kDivideAll) {
      divide_by_many(h);
    } else {
      for (const std::size_t g : used_)
        if (g != h) divide(h, g);
    }
    std::erase_if(cells_, [&](const PieceCell<Mask>& c) { return !is_surface(h, c.negative); });
    surface(h);
  }
}

template <std::size_t Bits>
void PieceCutter<Bits>::divide_by_many(std::size_t h) {
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
    std::erase_if(cells_, [&](const PieceCell<Mask>& c) { return !may_be_surface(h, c.negative, known); });
  }
}

template <std::size_t Bits>
auto PieceCutter<Bits>::first_cell(std::size_t h) const -> PieceCell<Mask> {
  std::array<std::array<std::uint8_t, 2>, 4> ends;
  const std::size_t n = polygon(h, ends);
  PieceCell<Mask> cell;
  for (std::size_t k = 0; k < n; ++k) {
    const auto &a = ends[k], &b = ends[(k + 1) % n];
    std::uint8_t plane = 0;  // face of both edges: opposite to the vertex that neither has
    while (plane == a[0] || plane == a[1] || plane == b[0] || plane == b[1]) ++plane;
    cell.edge.push_back(plane);
  }
  return cell;
}

template <std::size_t Bits>
void PieceCutter<Bits>::divide(std::size_t h, std::size_t g) {
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
    PieceCell<Mask> below{{}, cells_[c].negative}, above{{}, cells_[c].negative};
    below.negative.set(g);
    for (std::size_t i = 0; i < n; ++i) {
      const int here = signs_[i], next = signs_[(i + 1) % n];
      for (PieceCell<Mask>* part : {&below, &above}) {
        const int side = part == &below ? -1 : 1;
        if (here == side || next == side) part->edge.push_back(cells_[c].edge[i]);
        if (here == side && next != side) part->edge.push_back(plane);
      }
    }
    cells_[c] = std::move(below);
    cells_.push_back(std::move(above));
  }
}

template <std::size_t Bits>
bool PieceCutter<Bits>::shared_corner(std::size_t h, const Corner& c, Mask negative) {
  return c.b < 4 || c.a >= 4 || !is_surface(h, negative.flip(c.b - 4u));
}

template <std::size_t Bits>
void PieceCutter<Bits>::surface(std::size_t h) {
  struct Side {  // along a face
    std::uint32_t from, to;
    std::uint8_t face;
    bool from_shared, to_shared;
  };
  std::vector<Side> sides;
  bool odd = false;
  for (const PieceCell<Mask>& cell : cells_) {
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

}  // namespace sansmesh::inline v1
