// Lines as tubes with colours, beside the scale of these.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/image.h"
#include "sansmesh/option.h"
#include "sansmesh/polyline_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/render_options.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

struct LinePictureOptions {
  std::string color_by = {};               ///< an array of the points, of vectors their length; empty: the usual one
  std::string unit = {};                   ///< of that, at the scale
  std::optional<double> tube_radius = {};  ///< length; default: 1/400 of the lines' diagonal
  /// Its width is that of tubes and scale together. Shadows and ground mean nothing: colours are to be read.
  RenderOptions look = {};
  bool any_view = true;        ///< nobody chose the view: that of a single layer looks straight at it
  bool any_background = true;  ///< nobody chose the background: it is light gray

  /// Without `look`.
  static const OptionSchema& schema();
  /// Throws ArgumentError for bad options, and where the picture is too narrow for its scale. `usual`: what colours are
  /// by if nothing is said.
  void validate(const std::string& usual) const;
  /// Throws ArgumentError unless colours are by one of these arrays.
  void check_color(const std::vector<std::string>& arrays) const;
};

struct LinePicture {
  Image image;
  RenderOptions look;    ///< with which it was made
  std::string color_by;  ///< the array
  double lower = 0, upper = 0, radius = 0;
  std::size_t triangles = 0;

  static const ReportSchema& schema();
};

/// Radius of the tubes that lines are drawn as: the given one, or 1/400 of their diagonal. Throws DataError where all
/// points are in one place.
double tube_radius(const PolylineSet& lines, const std::optional<double>& radius = {});

/// Each value counts for the scale as much as it has of the tubes, a hundredth at each end is left out. Throws
/// ArgumentError for bad options, DataError where there is nothing to draw.
LinePicture line_picture(const PolylineSet& lines, const LinePictureOptions& options, const std::string& usual,
                         Progress& progress);

}  // namespace sansmesh::inline v1
