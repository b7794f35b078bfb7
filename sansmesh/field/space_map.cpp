#include "sansmesh/field/space_map.h"

#include <algorithm>
#include <limits>

namespace sansmesh {

void SpaceMap::images(std::span<const Box3> boxes, std::span<Box3> found) const {
  constexpr double kEnd = std::numeric_limits<double>::infinity();
  std::fill_n(found.begin(), boxes.size(), Box3{{-kEnd, -kEnd, -kEnd}, {kEnd, kEnd, kEnd}});
}

}  // namespace sansmesh
