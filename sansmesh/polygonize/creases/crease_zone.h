// The part of a mesh near the creases of its field, in which creases become edges.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sansmesh/polygonize/editable_surface.h"
#include "sansmesh/polygonize/pieces/piece_meeting.h"

namespace sansmesh::inline v1 {

/// The pieces that a vertex is on, with their unit normals there.
struct PieceLabel {
  PieceSet pieces;
  /// Dimension spanned by the normals: 1 on a smooth part, 2 on a crease, 3 in a corner; 0 for vertices that are not on
  /// the surface (a cap that closes the mesh) and must not change.
  std::uint8_t rank = 0;
  std::array<Vec3f, PieceSet::kMost> normal;

  Vec3 normal_of(std::uint32_t p) const {
    for (std::size_t i = 0; i < pieces.count; ++i)
      if (pieces.piece[i] == p) return Vec3(normal[i]);
    return {};
  }
};

struct CreaseZone {
  static constexpr std::uint32_t kNone = EditableSurface::kNone;

  const PiecewiseField& field;
  EditableSurface surface;
  std::vector<Vec3> x;
  std::vector<double> size;  ///< initial mean edge length at each vertex
  std::vector<PieceLabel> label;
  std::vector<std::uint32_t> piece;  ///< piece of each triangle; kNone: it crosses a crease that could not be placed

  CreaseZone(const PiecewiseField& f, std::vector<Triangle> triangles, std::vector<Vec3> vertices);

  /// Runs all steps below, in this order.
  void resolve();
  /// Moves each vertex onto the piece that is active there.
  void move_onto_pieces();
  /// Moves vertices close to a crease or a corner onto it.
  void snap();
  /// Flips edges between vertices without a common piece, or adds a vertex on the crease that they cross.
  void split();
  /// Assigns to each triangle the piece that its corners share.
  void assign_pieces();
  /// Repairs thin or folded triangles by flips, collapses and moves; creases and corners keep their positions.
  void improve();

  /// 4√3 area / Σ edges² of a triangle on a piece; negative if it is folded against the piece's normals.
  double shape(const std::array<Vec3, 3>& p, const Triangle& t, std::uint32_t on) const;
  double shape(const Triangle& t, std::uint32_t on) const { return shape({x[t[0]], x[t[1]], x[t[2]]}, t, on); }
  PieceSet shared(const Triangle& t) const {
    return common(common(label[t[0]].pieces, label[t[1]].pieces), label[t[2]].pieces);
  }
  bool crease_edge(std::uint32_t h) const;

 private:
  /// Computes normals and ranks of these vertices; with `look_around`, first adds neighbours' pieces that vanish there.
  void settle(const std::vector<std::uint32_t>& vertices, bool look_around);
  bool crosses(std::uint32_t a, std::uint32_t b) const;
  bool may_snap(std::uint32_t v, const Meeting& m) const;
  bool corner_near(std::uint32_t v, const Vec3& p, double distance) const;
  void merge_coincident();
  std::size_t flip_crossing();
  /// An edge that crosses a crease.
  struct Crossing {
    std::uint32_t from, to;
    double low = 0, high = 1;  ///< the crease is between these positions on the edge
    std::uint32_t next = 0;    ///< piece on which the edge leaves those of its first vertex
    std::size_t first = 0;     ///< index of its first meeting
  };
  std::vector<Crossing> find_crossings() const;
  /// Candidates for a vertex on each crossing, those of an edge together.
  std::vector<Meeting> meetings_on(std::vector<Crossing>& crossings) const;
  std::size_t split_crossing(int round);
  std::size_t split_triangles();
  std::uint32_t add_vertex(const Vec3& p, double h, const Meeting& m);
  double least_around(std::uint32_t v) const;
  double penalty(const Triangle& t, std::uint32_t on) const;  ///< 0 for a well-shaped triangle
  std::uint32_t best_piece(const Triangle& t) const;          ///< best of the corners' common pieces
  double flip_gain(std::uint32_t h, std::array<std::uint32_t, 2>& pieces) const;
  bool in_a_row(std::uint32_t t) const;  ///< all corners on one crease: the triangle has no area
  double collapse_gain(std::uint32_t h) const;
  bool repair(std::uint32_t t);
  void relax();
  void mark_around(std::uint32_t v);

  std::vector<std::uint8_t> marked_;  ///< triangles changed since repair() last found nothing to do for them
};

}  // namespace sansmesh::inline v1
