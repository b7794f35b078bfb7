// Fields that are minima and maxima of smooth functions, and say which: from that a mesh can be cut out that has walls
// of any thickness.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/field/piecewise_field.h"

namespace sansmesh::inline v1 {

/// A field whose pieces are put together by minima and maxima alone: its sign follows from the signs of the pieces. Its
/// gradients and those of its pieces are 1 at most. Immutable, safe from several threads.
class PieceExpression : public PiecewiseField {
 public:
  /// A piece, or the smaller or the larger one of two nodes that come before.
  struct Node {
    enum class Kind : std::uint8_t { piece, least, greatest };
    Kind kind = Kind::piece;
    std::uint32_t a = 0;  ///< a piece: its number; else a node
    std::uint32_t b = 0;
  };

  /// The last one is the field. The same piece may occur more than once.
  const std::vector<Node>& nodes() const { return nodes_; }

  /// A bound for the second derivatives of a piece (the norm of its Hessian, 1/length) where it vanishes within
  /// `radius` of x; infinity where there is none: at a tip, or a crease of its own.
  virtual double bend(std::uint32_t piece, const Vec3& x, double radius) const = 0;
  /// Whether it is known to bend across one direction only, as cylinders and cones do.
  virtual bool bends_one_way(std::uint32_t) const { return false; }

  /// Pieces that blend two others are the same as one of these where that is far below the other. The piece that is the
  /// same at all of x, to the last digit; itself if there is none.
  virtual std::uint32_t same_at(std::uint32_t piece, std::span<const Vec3> x) const = 0;
  /// The same within `radius` of x.
  virtual std::uint32_t same_within(std::uint32_t piece, const Vec3& x, double radius) const = 0;

  // Of all nodes: no quick way, but these are asked at a few points only.
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  void active(std::span<const Vec3> x, std::span<std::uint32_t> piece) const override;
  std::optional<double> slope_bound() const override { return 1; }

 protected:
  std::vector<Node> nodes_;
};

}  // namespace sansmesh::inline v1
