// Maps of handles that are points, many places at a time.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sansmesh/deform/polynomial_terms.h"
#include "sansmesh/deform_options.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// Handles as a structure of arrays, and what is fitted to them.
struct PointMap {
  DeformationKind kind = DeformationKind::rigid;
  std::vector<double> q[3], p[3], weight;
  double alpha = 1;
  double damping = 1;       ///< of what is behind cuts
  double floor_square = 0;  ///< distances whose squares are below this have the weight of this
  double unit = 1;          ///< polynomials are of coordinates times this
  PolynomialTerms terms;    ///< of `affine`, too
};

/// Where each of x comes from, what fit_nodes() says but for rounding, and p where x is q. Anything where x is not
/// finite. `extras`: of handle h and place i, [x.size() h + i], how much longer the way around the cuts is; or empty.
void map_places(const PointMap& map, std::span<const Vec3> x, std::span<const double> extras,
                std::span<Vec3> positions);

}  // namespace sansmesh::inline v1::detail
