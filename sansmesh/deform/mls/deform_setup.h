// Handles and precomputed data of MlsDeformation.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/deform/handles/deform_handle.h"
#include "sansmesh/deform/mls/polynomial_terms.h"
#include "sansmesh/deform_options.h"

namespace sansmesh::inline v1::detail {

/// Handles that are collinear, before or after, leave the rotation about their line undetermined.
enum class HandleLine : std::uint8_t { none, after, before, point };

struct DeformSetup {
  std::vector<DeformHandle> handles;
  MlsDeformationOptions options;
  double extent = 1;        ///< diagonal of the box of the deformed handles; 1 if they coincide
  double floor_square = 0;  ///< squared distances below this count as this
  PolynomialTerms terms;    ///< for affine and nonlinear deformations
  HandleLine line = HandleLine::none;
  Vec3 line_direction;  ///< unit vector
  bool plain = true;    ///< all handles are points without directions
};

/// Throws ArgumentError as MlsDeformation does.
DeformSetup set_up_deformation(const std::vector<Handle>& handles, const MlsDeformationOptions& options);

}  // namespace sansmesh::inline v1::detail
