// Options of deformations by moving least squares.
#pragma once

#include <cstdint>
#include <string_view>

#include "sansmesh/option.h"

namespace sansmesh::inline v1 {

enum class DeformationKind : std::uint8_t {
  affine,      ///< at least 4 handles, not in a plane
  similarity,  ///< turns and scales
  rigid,       ///< turns
  nonlinear,   ///< polynomials of `degree`; bends
};

/// "affine", "similarity", …
std::string_view kind_word(DeformationKind kind);

struct MlsDeformationOptions {
  DeformationKind kind = DeformationKind::rigid;
  /// Nonlinear: 2 (9 handles in general position) or 3 (19). With no more than that, or where the handles lie on a
  /// sphere or its like, terms of the highest degree whose Laplacian is not 0 are left out.
  int degree = 2;
  /// Weights are 1 / distance^(2 alpha); 0.5..8, with segments 1..8. At 0.5 the map has creases at handles. Above about
  /// 4 places are seldom within reach of more than two handles as far as double precision goes.
  double alpha = 1;
  /// Influence on the far side of a cut falls with distance / (distance + damping · detour); >= 1.
  double damping = 1;

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

}  // namespace sansmesh::inline v1
