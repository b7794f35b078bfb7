// Internal representation of a handle in MlsDeformation.
#pragma once

#include <vector>

#include "sansmesh/deform_options.h"

namespace sansmesh::inline v1::detail {

struct DeformHandle {
  Vec3 p, q;
  Vec3 along_p, along_q;  ///< vector between the ends of a segment
  bool segment = false;   ///< `along_q` is not zero
  double weight = 1;
  std::vector<TurnedDirection> directions;  ///< unit vectors
  double reach = 0;
};

}  // namespace sansmesh::inline v1::detail
