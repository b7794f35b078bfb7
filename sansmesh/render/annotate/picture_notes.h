// Annotation of pictures: colour bar, legend, axes of a box, scale bar, title.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/image.h"
#include "sansmesh/render/scene/camera.h"
#include "sansmesh/render/scene/picture_scene.h"
#include "sansmesh/render_options.h"
#include "sansmesh/volume_look.h"

namespace sansmesh::inline v1 {

/// Round values that divide an interval (lower < upper) into about `count` parts, ascending; 0 is exactly 0.
std::vector<double> round_ticks(double lower, double upper, int count);
/// The shortest text that distinguishes a value from its neighbours `step` away, with − as the minus sign; empty for
/// non-finite values.
std::string tick_text(double value, double step);

/// A dark colour on light pictures, a light one on dark pictures.
Rgba ink_for(const Image& image);

/// Adds a colour bar on the right: the transfer function over its range, ticks, the title (quantity and unit) above it
/// unless empty, and lines across the bar at those `marks` that are in its range. The picture becomes wider by
/// color_bar_width(). The background of the bar repeats the last column of `paper`, a picture of the same height (null:
/// `image`). Pictures lower than 100 pixels stay unchanged.
Image with_color_bar(const Image& image, const TransferFunction& function, const std::string& title,
                     std::span<const double> marks = {}, const Image* paper = nullptr, const BarEnds& ends = {});
/// Title of a colour bar: "NAME [UNIT]", or only the name.
std::string with_unit(const std::string& name, const std::string& unit);
/// Width in pixels that the bar adds to a picture of this height.
int color_bar_width(int height, const TransferFunction& function, const std::string& title);

/// Background for annotation beside a picture with these options, of the same height: the last column of the
/// background, without content at the picture's edge.
Image annotation_background(const RenderOptions& options);

/// Meaning of a colour in a picture.
struct LegendEntry {
  Vec3f color;  ///< sRGB 0..1
  std::string name;
};
/// Adds a list of colours on the right, wider by legend_width(). Long names are cut and end in dots. The background of
/// the list repeats the last column of `paper`, as for colour bars. Pictures lower than 100 pixels stay unchanged.
Image with_legend(const Image& image, std::span<const LegendEntry> entries, const Image* paper = nullptr);
int legend_width(int height, std::span<const LegendEntry> entries);

/// Draws the edges of a box that are behind its content; to be called before the content is drawn.
void draw_box_edges(Image& image, const Box3& box, const PictureFrame& frame, const Camera& camera);
/// Draws ticks with values along one edge of the outline per direction, with the axis name and `unit`.
void draw_box_ticks(Image& image, const Box3& box, const PictureFrame& frame, const Camera& camera,
                    const std::string& unit);

/// For parallel rays: draws a bar of a round length, about a fifth of the picture's width, in the lower left corner,
/// with its length in units of `length` and their name.
void draw_scale_bar(Image& image, const PictureFrame& frame, const Camera& camera, double length,
                    const std::string& unit);

/// Draws a title in the upper left corner. Line breaks separate lines; text that is too wide is made smaller.
void draw_title(Image& image, std::string_view title);

}  // namespace sansmesh::inline v1
