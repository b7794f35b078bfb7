// A scale of colours with numbers, drawn into a picture.
#pragma once

#include <optional>
#include <string>

#include "sansmesh/data/image.h"

namespace sansmesh {

struct ColorBar {
  double range = 1;                      ///< ±range have the full colours
  bool both_sides = true;                ///< false: from 0 to range only
  std::optional<double> tolerance = {};  ///< marked on the bar, if within the range
};

/// Draws the colours of distance_color as a vertical bar at the right edge, with numbers beside it. Its size follows
/// the picture's; pictures too small for it (less than 80 × 100 pixels) stay as they are.
void draw_color_bar(Image& image, const ColorBar& bar);

/// Draws text in a font of 5 × 7 dots, each `dot` pixels large, with its upper left corner at (x, y): digits, + − . e
/// and spaces; other characters leave a gap. Beyond the picture nothing is drawn.
void draw_text(Image& image, int x, int y, int dot, const std::string& text);

/// Pixels that a text is wide.
int text_width(const std::string& text, int dot);

/// A number for a scale: four significant digits, as short as possible.
std::string scale_number(double value, bool with_sign);

}  // namespace sansmesh
