// Words for the values of OrientBy.
#pragma once

#include <string_view>

#include "sansmesh/points/normals/sensor_directions.h"

namespace sansmesh::inline v1 {

/// Words in the order of the enumerators.
inline constexpr std::string_view kOrientByWords[] = {"auto", "scanner", "rows", "flight", "up", "propagation"};

}  // namespace sansmesh::inline v1
