// Colour bars beside pictures.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sansmesh/attribute_table.h"
#include "sansmesh/image.h"
#include "sansmesh/render/annotate/picture_notes.h"
#include "sansmesh/render_options.h"
#include "sansmesh/surface/curvature_words.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/volume_look.h"

namespace sansmesh::inline v1 {

/// Colour bar beside a picture.
struct ColorBar {
  TransferFunction colors;
  std::string title;
  BarEnds ends = {};
  std::vector<double> marks = {};

  /// Width in pixels beside a picture of that height.
  int width(int height) const { return color_bar_width(height, colors, title); }
};
/// Bar of curvatures up to `range`, in the input's lengths. `beyond`: there are larger ones.
ColorBar curvature_bar(CurvatureQuantity quantity, double range, const std::string& unit, bool beyond);
/// A range whose numbers take the most space at a bar.
inline constexpr double kWidestNumbers = 1.2e-100;
/// Throws ArgumentError unless the picture has space for the bar, which errors call `what`.
void check_room_beside(const RenderOptions& picture, const ColorBar& bar, std::string_view what);
/// Reserves part of the picture's width for `what`, which `option = false` omits. Throws ArgumentError if too little is
/// left.
void reserve_width(RenderOptions& options, int width, std::string_view what, std::string_view option);
/// Reserves the width of a bar, if there is one.
void reserve_width(RenderOptions& options, const std::optional<ColorBar>& bar);
/// One number per row; the length for vectors.
std::vector<double> sizes_of(const Attribute& attribute);
/// Colours the vertices by an attribute, by the length for vectors; undefined values are grey. `range`: values at the
/// ends; default: all values except one hundredth at each end, symmetric if both signs occur. Throws DataError if there
/// is no such attribute or it has no finite value.
ColorBar color_by_attribute(TriangleMesh& mesh, const std::string& name,
                            const std::optional<std::pair<double, double>>& range, const std::string& unit);
/// Colours of the attribute `confidence` in pictures, 0..1.
ColorBar confidence_bar();
/// Adds the bar, if any, to the picture, on the picture's background.
Image beside_bar(const Image& image, const std::optional<ColorBar>& bar, const RenderOptions& picture);

}  // namespace sansmesh::inline v1
