// Conversion and interpolation of colours in several colour spaces.
#pragma once

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Linear light → sRGB; negative light is black, values above 1 stay above 1.
Vec3f srgb_color(const Vec3f& light);

/// CIE L*a*b* (white D65) of an sRGB colour, and back; colours outside sRGB are clamped to 0..1.
Vec3 lab_of_srgb(const Vec3f& srgb);
Vec3f srgb_of_lab(const Vec3& lab);

/// sRGB of a colour in Oklab [ottosson2020], given by lightness 0..1, chroma (>= 0) and hue (degrees). Chroma is
/// reduced to the sRGB range.
Vec3f srgb_of_oklch(double lightness, double chroma, double hue);

/// Interpolates two sRGB colours, t 0..1, through an almost white middle of low saturation [moreland2009].
Vec3f mix_diverging(const Vec3f& a, const Vec3f& b, double t);
/// Interpolates along the shorter arc of hue.
Vec3f mix_hsv(const Vec3f& a, const Vec3f& b, double t);

}  // namespace sansmesh::inline v1
