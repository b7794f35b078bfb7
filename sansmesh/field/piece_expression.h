// Fields that are expressions of minima and maxima of smooth functions: meshing uses the expression to resolve walls of
// any thickness.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/field/piecewise_field.h"

namespace sansmesh::inline v1 {

/// Field composed of its pieces by minima and maxima only, so that the signs of the pieces determine its sign. Gradient
/// norms of the field and its pieces are at most 1. Immutable, thread-safe.
class PieceExpression : public PiecewiseField {
 public:
  /// A piece, or the minimum or maximum of two earlier nodes.
  struct Node {
    enum class Kind : std::uint8_t { piece, least, greatest };
    Kind kind = Kind::piece;
    std::uint32_t a = 0;  ///< piece number, or first operand
    std::uint32_t b = 0;
  };

  /// Nodes; the last one is the field. A piece may occur more than once.
  const std::vector<Node>& nodes() const { return nodes_; }

  /// Bound for the second derivatives of a piece (norm of its Hessian, 1/length) where it vanishes within `radius` of
  /// x; infinite at a tip or crease of the piece.
  virtual double curvature_bound(std::uint32_t piece, const Vec3& x, double radius) const = 0;
  /// Whether the piece is known to curve in one direction only, as cylinders and cones do.
  virtual bool singly_curved(std::uint32_t) const { return false; }

  /// A blend of two pieces equals one of them where that is far below the other. Returns the piece that equals this one
  /// exactly at all of x; the piece itself if there is none.
  virtual std::uint32_t same_at(std::uint32_t piece, std::span<const Vec3> x) const = 0;
  /// Same, within `radius` of x.
  virtual std::uint32_t same_within(std::uint32_t piece, const Vec3& x, double radius) const = 0;

  // Evaluate all nodes: slow, but used at few points only.
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  void active(std::span<const Vec3> x, std::span<std::uint32_t> piece) const override;
  std::optional<double> slope_bound() const override { return 1; }

 protected:
  std::vector<Node> nodes_;
};

}  // namespace sansmesh::inline v1
