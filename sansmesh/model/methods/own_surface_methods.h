// Surfaces that the library has by itself.
#pragma once

#include <span>
#include <vector>

#include "sansmesh/model/surface_method.h"

namespace sansmesh {

/// Those of each source of this folder, in the order of its CMakeLists.txt, from which the definition is made.
std::vector<std::span<const SurfaceMethod>> own_surface_methods();

}  // namespace sansmesh
