// Shape functions of cells of higher order.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/cell_list.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// The shape functions of one kind of cell: each is 1 at its node and 0 at the others. In products of polynomials they
/// are those of Lagrange; the others are found in their space by solving for the nodes.
class NodalBasis {
 public:
  /// Throws DataError for orders that are not allowed.
  explicit NodalBasis(const HigherOrderKind& kind);

  const HigherOrderKind& kind() const { return kind_; }
  /// Natural coordinates of the nodes.
  std::span<const Vec3> nodes() const { return nodes_; }
  /// Values of the functions at u and their derivatives by natural coordinates, one per node.
  void evaluate(const Vec3& u, std::span<double> values, std::span<Vec3> slopes) const;
  /// Whether u is inside the cell, or outside by at most `margin`.
  bool within(const Vec3& u, double margin) const;
  /// Natural coordinates of a point well inside.
  Vec3 middle() const;

 private:
  /// r^a s^b t^c, divided by 1 − t if `over`.
  struct Term {
    int r, s, t;
    bool over;
  };
  void place_nodes();
  static std::vector<Term> terms_of(HigherOrderFamily family);
  static void evaluate_term(const Term& term, const Vec3& u, double& value, Vec3& slope);
  void solve();

  HigherOrderKind kind_;
  std::vector<Vec3> nodes_;
  std::vector<Term> terms_;           ///< empty for products
  std::vector<double> coefficients_;  ///< a row of nodes for each term
};

}  // namespace sansmesh::inline v1
