// Words for the values of OrientBy.
#pragma once

#include <string_view>

#include "sansmesh/points/normals/sensor_directions.h"

namespace sansmesh::inline v1 {

/// Words in the order of the enumerators.
inline constexpr std::string_view kOrientByWords[] = {"auto", "scanner", "rows", "flight", "up", "propagation"};

constexpr std::string_view orient_by_word(OrientBy by) { return kOrientByWords[static_cast<std::size_t>(by)]; }

}  // namespace sansmesh::inline v1
