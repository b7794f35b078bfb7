// Weighted fit of the local map at one point.
#pragma once

#include <vector>

#include "sansmesh/deform/mls/deform_setup.h"
#include "sansmesh/deform/mls/weighted_nodes.h"
#include "sansmesh/vector_field.h"

namespace sansmesh::inline v1::detail {

struct FittedPosition {
  Vec3 position;
  Jacobian jacobian{};
};

/// The source of x under the map of the setup's kind and, if `jacobian`, the derivatives with respect to x, weights
/// included. `scratch` is reused.
FittedPosition fit_nodes(const DeformSetup& setup, const NodesFrom& from, const Vec3& x, bool jacobian,
                         std::vector<double>& scratch);

}  // namespace sansmesh::inline v1::detail
