// A triangle surface that supports splitting, flipping and collapsing single edges.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// An oriented manifold, closed or with a border, as flat arrays: half-edge 3t + k runs from corner k of triangle t to
/// the next corner. Every operation preserves the oriented manifold and its topology; can_… reports whether an
/// operation is possible. Triangle indices stay valid: removed triangles are marked, new ones are appended.
class EditableSurface {
 public:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  /// `triangles` use vertices 0 .. vertices − 1; no edge has more than two triangles.
  EditableSurface(std::vector<Triangle> triangles, std::size_t vertices);

  std::size_t triangles() const { return triangle_.size(); }
  std::size_t vertices() const { return out_.size(); }
  const Triangle& operator[](std::size_t t) const { return triangle_[t]; }
  bool alive(std::size_t t) const { return triangle_[t][0] != triangle_[t][1]; }

  static std::uint32_t next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static std::uint32_t previous(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
  std::uint32_t from(std::uint32_t h) const { return triangle_[h / 3][h % 3]; }
  std::uint32_t to(std::uint32_t h) const { return from(next(h)); }
  std::uint32_t apex(std::uint32_t h) const { return from(previous(h)); }  ///< vertex opposite to h
  std::uint32_t twin(std::uint32_t h) const { return twin_[h]; }           ///< kNone at the border
  bool on_border(std::uint32_t v) const { return border_[v] != 0; }
  bool used(std::uint32_t v) const { return out_[v] != kNone; }

  /// Visits the half-edges that leave an inner vertex, in the order of their triangles around it.
  template <class Body>
  void around(std::uint32_t v, Body&& body) const {
    const std::uint32_t first = out_[v];
    if (first == kNone) return;
    std::uint32_t h = first;
    do {
      body(h);
      h = twin_[previous(h)];
    } while (h != first && h != kNone);
  }
  std::uint32_t valence(std::uint32_t v) const {
    std::uint32_t n = 0;
    around(v, [&](std::uint32_t) { ++n; });
    return n;
  }
  bool adjacent(std::uint32_t v, std::uint32_t w) const {
    bool found = false;
    around(v, [&](std::uint32_t h) { found = found || to(h) == w; });
    return found;
  }

  /// The half-edge from v to w, which must be an inner edge.
  std::uint32_t find(std::uint32_t v, std::uint32_t w) const {
    std::uint32_t found = kNone;
    around(v, [&](std::uint32_t h) { found = to(h) == w ? h : found; });
    around(w, [&](std::uint32_t h) { found = to(h) == v ? twin_[h] : found; });
    return found;
  }

  /// Splits an inner edge: from(h) → new → to(h). Afterwards half-edge h ends at the new vertex. Appends two triangles:
  /// the second half of h's triangle, then that of its twin's.
  std::uint32_t split_edge(std::uint32_t h);
  /// Splits a triangle into three; it keeps its first edge. Appends two triangles.
  std::uint32_t split_triangle(std::uint32_t t);

  /// Whether the edge can be replaced by the other diagonal of its two triangles.
  bool can_flip(std::uint32_t h) const;
  /// Afterwards the triangles are (from, other, apex) in place of h's and (other, to, apex) in place of its twin's.
  void flip(std::uint32_t h);

  /// Whether from(h) can be collapsed into to(h) (link condition; both vertices are inner).
  bool can_collapse(std::uint32_t h) const;
  void collapse(std::uint32_t h);

 private:
  void join(std::uint32_t g, std::uint32_t h) {
    twin_[g] = h;
    twin_[h] = g;
  }
  void join_outer(std::uint32_t h, std::uint32_t other) {
    twin_[h] = other;
    if (other != kNone) twin_[other] = h;
  }
  std::uint32_t add_vertex();
  std::uint32_t add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);

  std::vector<Triangle> triangle_;
  std::vector<std::uint32_t> twin_;
  std::vector<std::uint32_t> out_;  ///< a half-edge that leaves each vertex
  std::vector<std::uint8_t> border_;
};

}  // namespace sansmesh::inline v1
