// What colours in a picture stand for, beside it.
#pragma once

#include <optional>
#include <span>
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

/// The bar of colours beside a picture.
struct ColorBar {
  TransferFunction colors;
  std::string title;
  BarEnds ends;
};
/// That of curvatures up to `range`, in the input's lengths. `beyond`: there are others.
ColorBar curvature_bar(CurvatureQuantity quantity, double range, const std::string& unit, bool beyond);
/// Numbers at a bar may be as wide as those of −range..range with this.
inline constexpr double kWidestNumbers = 1.2e-100;
/// Throws ArgumentError unless such a picture has room for a bar of so many pixels, which is called so.
void check_room_beside(const RenderOptions& picture, int bar, std::string_view what);
/// Makes room for a bar in the width of the picture. Throws ArgumentError where there is none.
void leave_room(RenderOptions& options, const std::optional<ColorBar>& bar);
/// A number for each row: of vectors their length.
std::vector<double> sizes_of(const Attribute& attribute);
/// Colours the vertices by the attribute of that name, of vectors by their lengths; grey where it is not known.
/// `range`: what gets the colours at the ends; default: all of it but for one in a hundred at each end, symmetric where
/// there are both signs. Throws DataError where there is none of that name, or nothing is known.
ColorBar color_by_attribute(TriangleMesh& mesh, const std::string& name,
                            const std::optional<std::pair<double, double>>& range, const std::string& unit);
/// The colours that an attribute `confidence` has in pictures, 0..1.
ColorBar confidence_bar();
/// The picture with the bar, if there is one, on the background of the options that it was made with.
Image beside_bar(const Image& image, const std::optional<ColorBar>& bar, const RenderOptions& picture);

}  // namespace sansmesh::inline v1
