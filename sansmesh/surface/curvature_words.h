// Words for the quantities that curvature is shown by.
#pragma once

#include <string_view>

#include "sansmesh/surface/curvature_colors.h"

namespace sansmesh {

/// In the order of the enumerators.
inline constexpr std::string_view kCurvatureWords[] = {"mean", "gaussian", "k1", "k2"};

}  // namespace sansmesh
