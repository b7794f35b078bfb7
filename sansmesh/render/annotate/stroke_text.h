// Text in pictures, of strokes: a font of our own that fits any size.
#pragma once

#include <string_view>

#include "sansmesh/image.h"

namespace sansmesh::inline v1 {

/// Draws a line of a width with round ends from (x0, y0) to (x1, y1), smooth at its rim. Pixels, the middle of the
/// first is at 0.5; beyond the picture nothing is drawn. `ink`: sRGB with alpha.
void draw_line(Image& image, double x0, double y0, double x1, double y1, double width, const Rgba& ink);

/// Draws UTF-8 with the lower left corner of its first letter at (x, y), `height` the size of a capital letter in
/// pixels. ASCII, − ± × · ° µ ² ³; a box stands for what else there is.
void draw_strokes(Image& image, double x, double y, double height, std::string_view text, const Rgba& ink);

/// Pixels that a text is wide at this size.
double stroke_width(std::string_view text, double height);

}  // namespace sansmesh::inline v1
