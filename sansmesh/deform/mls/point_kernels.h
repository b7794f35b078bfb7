// Vectorised maps of point handles.
#pragma once

#include <span>
#include <vector>

#include "sansmesh/deform/mls/polynomial_terms.h"
#include "sansmesh/deform_options.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// Handles as a structure of arrays, with the parameters of the fit.
struct PointMap {
  DeformationKind kind = DeformationKind::rigid;
  std::vector<double> q[3], p[3], weight;
  double alpha = 1;
  double damping = 1;       ///< damping of influence across cuts
  double floor_square = 0;  ///< squared distances below this count as this
  double unit = 1;          ///< scale of the coordinates in polynomials
  PolynomialTerms terms;    ///< also for `affine`
};

/// The source of each x: equals fit_nodes() up to rounding, and p where x is q. Undefined where x is not finite.
/// `extras`: extra length of the detour from handle h to point i at [x.size() h + i]; or empty.
void map_positions(const PointMap& map, std::span<const Vec3> x, std::span<const double> extras,
                   std::span<Vec3> positions);

}  // namespace sansmesh::inline v1::detail
