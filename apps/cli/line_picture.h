// Lines as tubes with colours: the picture beside a file of lines.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "command_line.h"
#include "option_groups.h"
#include "sansmesh/core/progress.h"
#include "sansmesh/data/image.h"
#include "sansmesh/data/polyline_set.h"

namespace sansmesh::cli {

struct LinePictureArguments {
  std::string file, color_by, unit, background;
  std::optional<double> radius;
  PictureArguments picture;

  /// Throws ArgumentError for bad options and for some that need --preview, FileError where it cannot be written.
  /// `usual`: what colours are by without --color-by.
  void check(const std::string& usual) const;
  /// Throws ArgumentError unless --color-by is one of these arrays, or absent.
  void check_color(const std::vector<std::string>& arrays) const;
};

/// What was drawn, and how.
struct LinePicture {
  Image image;
  RenderOptions look;    ///< with which it was made
  std::string color_by;  ///< the array
  double lower = 0, upper = 0, radius = 0;
  std::size_t triangles = 0;
};

/// --preview, --color-by, --unit, --tube-radius, --background and those of add_picture_options
void add_line_picture(CommandLine& command, LinePictureArguments& arguments);

/// Colours by --color-by, an array of the points, of vectors their lengths; without it by `usual`, of which
/// there must be one. Throws DataError where there is nothing to draw.
LinePicture draw_lines(const PolylineSet& lines, const LinePictureArguments& arguments, const std::string& usual,
                       Progress& progress);

}  // namespace sansmesh::cli
