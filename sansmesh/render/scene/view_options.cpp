#include "sansmesh/render_options.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "sansmesh/core/option_text.h"
#include "sansmesh/error.h"
#include "sansmesh/render/annotate/picture_crop.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::string_view kContent = "content";
constexpr std::string_view kNamedViews[] = {"front", "back", "left", "right", "top", "bottom", "iso"};

/// Four integers separated by commas, the size at least 1.
std::optional<PixelBox> pixel_box_of(std::string_view text) {
  const std::vector<std::string> words = between_commas(text);
  if (words.size() != 4) return std::nullopt;
  PixelBox box;
  std::size_t k = 0;
  for (int* const value : {&box.left, &box.top, &box.width, &box.height}) {
    const auto number = whole_in(words[k], k < 2 ? 0 : 1, std::numeric_limits<int>::max());
    if (!number) return std::nullopt;
    *value = static_cast<int>(*number), ++k;
  }
  return box;
}

}  // namespace

std::string text_of_option(const PictureCrop& crop) {
  if (!crop.box) return std::string(kContent);
  return fmt::format("{},{},{},{}", crop.box->left, crop.box->top, crop.box->width, crop.box->height);
}

void option_of_text(std::string_view text, PictureCrop& crop) {
  crop.box = pixel_box_of(text);
  if (!crop.box && text != kContent)
    throw ArgumentError(ArgumentFault{.field = {},
                                      .value = "'" + printable(text, 60) + "'",
                                      .allowed = "LEFT,TOP,WIDTH,HEIGHT in pixels, or " + std::string(kContent),
                                      .remedy = {}});
}

const OptionSchema& ViewOptions::schema() {
  using O = ViewOptions;
  static constexpr OptionRow rows[] = {
      option<&O::view>({.text = "front, back, left, right, top, bottom or iso", .choices = kNamedViews}),
      option<&O::azimuth>({.text = "Degrees around the up axis; 0: the front", .unit = "degrees", .from_data = "35"}),
      option<&O::elevation>({.text = "Degrees above the horizon", .unit = "degrees", .from_data = "20"}),
      option<&O::z_up>({.text = "The z axis points up, not y"}),
      option<&O::crop>(
          {.text = "Crop to LEFT,TOP,WIDTH,HEIGHT in pixels, or to the content", .unit = "part", .implied = kContent})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

RenderOptions ViewOptions::applied_to(RenderOptions o) const {
  validate_options(*this);
  if (azimuth) o.view.direction.azimuth = *azimuth;
  if (elevation) o.view.direction.elevation = *elevation;
  if (view) o.view.direction = named_view(std::string(kNamedViews[static_cast<std::size_t>(*view)]));
  if (z_up) o.view.up = UpAxis::z;
  if (crop && crop->box) check_crop(*crop->box, o.view.width, o.view.height);  // before long computations
  return o;
}

void ViewOptions::check_frames(bool several) const {
  if (several && crop && !crop->box)
    throw ArgumentError("`crop` of several pictures needs LEFT,TOP,WIDTH,HEIGHT, so that all have one size");
}

Image ViewOptions::part_of(const Image& image, const RenderOptions& made_with) const {
  if (!crop) return image;
  return cropped(image, crop->box ? *crop->box : picture_content(image, made_with, std::max(2, image.height / 60)));
}

}  // namespace sansmesh::inline v1
