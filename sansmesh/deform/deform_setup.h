// Handles as MlsDeformation uses them, and what it finds out about them once.
#pragma once

#include <cstdint>
#include <vector>

#include "sansmesh/deform/deform_handle.h"
#include "sansmesh/deform/polynomial_terms.h"
#include "sansmesh/deform_options.h"

namespace sansmesh::inline v1::detail {

/// Handles that lie on a line, before or after, leave the turn about it open.
enum class HandleLine : std::uint8_t { none, after, before, point };

struct DeformSetup {
  std::vector<DeformHandle> handles;
  MlsDeformationOptions options;
  double extent = 1;        ///< diagonal of the box of the handles after the deformation; 1 if they are one point
  double floor_square = 0;  ///< points whose squared distances are below this have the weight of this
  PolynomialTerms terms;    ///< of affine and nonlinear deformations
  HandleLine line = HandleLine::none;
  Vec3 line_direction;  ///< of length 1
  bool plain = true;    ///< all handles are points without directions
};

/// Throws ArgumentError as MlsDeformation does.
DeformSetup set_up_deformation(const std::vector<Handle>& handles, const MlsDeformationOptions& options);

}  // namespace sansmesh::inline v1::detail
