// What colours in a picture stand for, beside it.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <utility>

#include "option_groups.h"
#include "sansmesh/data/attribute_table.h"
#include "sansmesh/data/image.h"
#include "sansmesh/data/triangle_mesh.h"
#include "sansmesh/render/picture_notes.h"
#include "sansmesh/render/transfer_function.h"

namespace sansmesh::cli {

/// The bar of colours beside a picture.
struct ColorBar {
  TransferFunction colors;
  std::string title;
  BarEnds ends;
};
/// That of curvatures up to `range`, in the input's lengths. `beyond`: there are others.
ColorBar curvature_bar(CurvatureQuantity quantity, double range, const std::string& unit, bool beyond);
/// Makes room for a bar in the width of the picture. Throws ArgumentError where there is none.
void leave_room(RenderOptions& options, const std::optional<ColorBar>& bar);
/// Colours the vertices by the attribute of that name, of vectors by their lengths; grey where it is not known.
/// `range`: what gets the colours at the ends; default: all of it but for one in a hundred at each end, symmetric where
/// there are both signs. Throws DataError where there is none of that name, or nothing is known.
ColorBar color_by_attribute(TriangleMesh& mesh, const std::string& name,
                            const std::optional<std::pair<double, double>>& range, const std::string& unit);
/// The colours that an attribute `confidence` has in pictures, 0..1.
ColorBar confidence_bar();
/// The picture with the bar, if there is one, on the background of the options that it was made with.
Image beside_bar(const Image& image, const std::optional<ColorBar>& bar, const RenderOptions& look);

/// --no-bar, --unit: what `of` says the unit is of.
void add_bar_options(CommandLine& command, bool& no_bar, std::string& unit, const std::string& of);

}  // namespace sansmesh::cli
