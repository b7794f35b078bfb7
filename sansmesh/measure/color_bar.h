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

/// The picture with the colours of distance_color as a vertical bar and numbers to its right: wider by
/// color_bar_width(), so that nothing is covered. The last column of pixels goes on behind it. Pictures lower than 100
/// pixels stay as they are.
Image beside_color_bar(const Image& image, const ColorBar& bar);

/// Pixels that a bar adds to a picture of this height.
int color_bar_width(int height, const ColorBar& bar);

/// Draws text in a font of 5 × 7 dots, each `dot` pixels large, with its upper left corner at (x, y): digits, + − . e
/// and spaces; other characters leave a gap. Beyond the picture nothing is drawn.
void draw_text(Image& image, int x, int y, int dot, const std::string& text);

/// Pixels that a text is wide.
int text_width(const std::string& text, int dot);

/// A number for a scale: four significant digits, as short as possible.
std::string scale_number(double value, bool with_sign);

}  // namespace sansmesh
