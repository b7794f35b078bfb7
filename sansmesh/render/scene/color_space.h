// Colours in the coordinates in which they are mixed.
#pragma once

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Linear light → sRGB; negative light is black, more than white stays more than 1.
Vec3f srgb_color(const Vec3f& light);

/// CIE L*a*b* (white D65) of an sRGB colour, and back; what sRGB cannot show is clamped to 0..1.
Vec3 lab_of_srgb(const Vec3f& srgb);
Vec3f srgb_of_lab(const Vec3& lab);

/// sRGB of a colour in Oklab [ottosson2020], given by lightness 0..1, colourfulness (>= 0) and hue (degrees): as
/// colourful as that, or as sRGB can show it.
Vec3f srgb_of_oklch(double lightness, double chroma, double hue);

/// Between two sRGB colours, t 0..1, with saturation falling to an almost white middle [moreland2009].
Vec3f mix_diverging(const Vec3f& a, const Vec3f& b, double t);
/// Along the hue, the shorter way round.
Vec3f mix_hsv(const Vec3f& a, const Vec3f& b, double t);

}  // namespace sansmesh::inline v1
