// A handle as MlsDeformation uses it.
#pragma once

#include <vector>

#include "sansmesh/deform_options.h"

namespace sansmesh::inline v1::detail {

struct DeformHandle {
  Vec3 p, q;
  Vec3 along_p, along_q;  ///< from one end of a segment to the other
  bool segment = false;   ///< `along_q` is not zero
  double weight = 1;
  std::vector<TurnedDirection> directions;  ///< of length 1
  double reach = 0;
};

}  // namespace sansmesh::inline v1::detail
