// Colours for numbers with a sign.
#pragma once

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Blue at −1, white at 0, red at +1 (sRGB 0..1; values beyond are clamped): two ramps of even perceptual steps, mirror
/// images of each other in lightness and colourfulness (straight lines in Oklab, Ottosson 2020).
Vec3f diverging_color(float t);

}  // namespace sansmesh::inline v1
