// Text in pictures as strokes: a built-in font for any size.
#pragma once

#include <string_view>

#include "sansmesh/image.h"

namespace sansmesh::inline v1 {

/// Draws an antialiased line of a width with round ends from (x0, y0) to (x1, y1). Pixel coordinates; the centre of the
/// first pixel is at 0.5. Lines are clipped at the picture. `ink`: sRGB with alpha.
void draw_line(Image& image, double x0, double y0, double x1, double y1, double width, const Rgba& ink);

/// Draws UTF-8 text; (x, y) is the lower left corner of the first letter, `height` the size of a capital letter in
/// pixels. Characters: ASCII, − ± × · ° µ ² ³; a box replaces all others.
void draw_strokes(Image& image, double x, double y, double height, std::string_view text, const Rgba& ink);

/// Width of a text in pixels at this size.
double stroke_width(std::string_view text, double height);

}  // namespace sansmesh::inline v1
