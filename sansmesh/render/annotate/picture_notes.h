// What stands around a picture of data: a scale of colours, the axes of its box, a title.
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

/// Round values that cut an interval (lower < upper) into about `count` parts, ascending; 0 is exactly 0.
std::vector<double> round_ticks(double lower, double upper, int count);
/// A value as short as it is told apart from its neighbours `step` away, with a − of its own; an empty text for what is
/// not finite.
std::string tick_text(double value, double step);

/// Dark on light, light on dark.
Rgba ink_for(const Image& image);

/// The picture with the colours of a transfer function over its range as a bar to its right, ticks and, where there is
/// a title (what is shown, and its unit), that above; lines across the bar at `marks`, as far as they lie in its range.
/// Wider by value_bar_width(); behind it the last column of `paper` goes on, a picture of the same height (null: that
/// of the picture itself). Pictures lower than 100 pixels stay as they are.
Image beside_value_bar(const Image& image, const TransferFunction& function, const std::string& title,
                       std::span<const double> marks = {}, const Image* paper = nullptr, const BarEnds& ends = {});
/// Title of a colour bar: "NAME [UNIT]", or the name alone.
std::string with_unit(const std::string& name, const std::string& unit);
/// Pixels that the bar adds to a picture of this height.
int value_bar_width(int height, const TransferFunction& function, const std::string& title);

/// What stands beside a picture made with these options, of its height: the last column of its background, without what
/// reaches the picture's edge.
Image paper_beside(const RenderOptions& options);

/// What a colour in a picture stands for.
struct LegendEntry {
  Vec3f color;  ///< sRGB 0..1
  std::string name;
};
/// The picture with the list to its right, wider by legend_width(); names too long end in dots. Behind the list the
/// last column of `paper` goes on, as beside bars. Pictures lower than 100 pixels stay as they are.
Image beside_legend(const Image& image, std::span<const LegendEntry> entries, const Image* paper = nullptr);
int legend_width(int height, std::span<const LegendEntry> entries);

/// The outline of a box in the world: the edges behind what is seen, to be drawn before it.
void draw_box_edges(Image& image, const Box3& box, const PictureFrame& frame, const Camera& camera);
/// Ticks with values along one edge of the outline in each direction, with the axis' name and `unit`.
void draw_box_ticks(Image& image, const Box3& box, const PictureFrame& frame, const Camera& camera,
                    const std::string& unit);

/// Of parallel rays: a bar of a round length, about a fifth of the picture's width, in the lower left corner, with the
/// length in units of `length` and their name.
void draw_scale_bar(Image& image, const PictureFrame& frame, const Camera& camera, double length,
                    const std::string& unit);

/// In the upper left corner. Lines are separated by line breaks; text too wide is made smaller.
void draw_title(Image& image, std::string_view title);

}  // namespace sansmesh::inline v1
