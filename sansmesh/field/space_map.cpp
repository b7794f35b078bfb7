#include "sansmesh/space_map.h"

#include <algorithm>
#include <limits>

namespace sansmesh::inline v1 {

void SpaceMap::images(std::span<const Box3> boxes, std::span<Box3> found) const {
  constexpr double kEnd = std::numeric_limits<double>::infinity();
  std::fill_n(found.begin(), boxes.size(), Box3{{-kEnd, -kEnd, -kEnd}, {kEnd, kEnd, kEnd}});
}

}  // namespace sansmesh::inline v1
