// Diverging colour map for signed numbers.
#pragma once

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Blue at −1, white at 0, red at +1 (sRGB 0..1; values outside are clamped). Both ramps have even perceptual steps and
/// mirror each other in lightness and chroma (straight lines in Oklab; ottosson2020).
Vec3f diverging_color(float t);

}  // namespace sansmesh::inline v1
