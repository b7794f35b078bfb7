// The map that carries weighted nodes best, at one place.
#pragma once

#include <vector>

#include "sansmesh/deform/deform_setup.h"
#include "sansmesh/deform/weighted_nodes.h"
#include "sansmesh/vector_field.h"

namespace sansmesh::inline v1::detail {

struct FittedPlace {
  Vec3 position;
  Jacobian jacobian{};
};

/// Where x comes from by the map of the setup's kind, and if wanted the derivatives of that as a function of x, weights
/// included. `scratch` is reused.
FittedPlace fit_nodes(const DeformSetup& setup, const NodesFrom& from, const Vec3& x, bool jacobian,
                      std::vector<double>& scratch);

}  // namespace sansmesh::inline v1::detail
