#include "picture_options.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string_view>
#include <system_error>
#include <utility>

#include "option_values.h"
#include "sansmesh/core/error.h"
#include "sansmesh/io/io.h"
#include "sansmesh/render/picture_crop.h"
#include "schema_options.h"

namespace sansmesh::cli {
namespace {

constexpr const char* kContent = "content";

/// LEFT,TOP,WIDTH,HEIGHT
std::optional<PixelBox> pixel_box_of(const std::string& text) {
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

bool PictureArguments::any() const { return !options_set(options).empty() || has_view() || !crop.empty() || z_up; }

RenderOptions PictureArguments::chosen() const {
  RenderOptions o = options;
  if (azimuth) o.view.azimuth = *azimuth;
  if (elevation) o.view.elevation = *elevation;
  if (!view.empty()) o.view = named_view(view);
  if (z_up) o.up = UpAxis::z;
  if (crop.empty() || crop == kContent) return o;
  const auto box = pixel_box_of(crop);
  if (!box)
    throw ArgumentError("--crop must be LEFT,TOP,WIDTH,HEIGHT in pixels, or " + std::string(kContent) + ", not '" +
                        printable(crop, 60) + "'");
  check_crop(*box, o.width, o.height);  // before all the work
  return o;
}

void PictureArguments::check_frames(bool several) const {
  if (several && crop == kContent)
    throw ArgumentError("--crop of several pictures needs LEFT,TOP,WIDTH,HEIGHT, so that all have one size");
}

Image PictureArguments::part(const Image& image, const RenderOptions& made_with) const {
  if (crop.empty()) return image;
  const auto box = pixel_box_of(crop);
  return cropped(image, box ? *box : picture_content(image, made_with, std::max(2, image.height / 60)));
}

Image PictureArguments::write(const std::string& file, const Image& image, const RenderOptions& made_with) const {
  Image written = part(image, made_with);
  write_image(file, written);
  return written;
}

void set_background(RenderOptions& o, const std::string& word) {
  using Background = RenderOptions::Background;
  if (word == "transparent") o.background = Background::transparent;
  if (word == "white" || word == "black") {
    o.background = Background::solid;
    o.background_color = word == "white" ? Vec3f{1, 1, 1} : Vec3f{0, 0, 0};
  }
}

std::string frame_name(const std::string& output, std::size_t frame, int digits) {
  const std::filesystem::path path(output);
  return (path.parent_path() /
          fmt::format("{}_{:0{}}{}", path.stem().string(), frame, digits, path.extension().string()))
      .string();
}

void add_background_option(CommandLine& c, std::string& word, const std::string& usual) {
  c.add_option("--background", word, "gradient, white, black or transparent [" + usual + "]")
      .one_of({"gradient", "white", "black", "transparent"})
      .type_name("NAME")
      .group("Picture");
}

void add_picture_options(CommandLine& c, PictureArguments& a) {
  const char* const group = "Picture";
  add_schema(c, a.options, {.group = group, .only = {"width", "height"}});
  c.add_option("--view", a.view, "front, back, left, right, top, bottom or iso")
      .one_of({"front", "back", "left", "right", "top", "bottom", "iso"})
      .type_name("NAME")
      .group(group);
  c.add_option("--azimuth", a.azimuth, "Degrees around the up axis; 0: the front [35]")
      .type_name("DEGREES")
      .group(group);
  c.add_option("--elevation", a.elevation, "Degrees above the horizon [20]").type_name("DEGREES").group(group);
  c.add_flag("--z-up", a.z_up, "The z axis points up, not y").group(group);
  add_schema(c, a.options,
             {.group = group,
              .only = {"field_of_view", "orthographic", "scale_bar", "look_at", "zoom", "look_radius", "clip_box"}});
  c.add_option("--crop", a.crop,
               "Part of the picture, LEFT,TOP,WIDTH,HEIGHT in pixels [no value: what is not background]")
      .type_name("PART")
      .without_value(kContent)
      .group(group);
}

void add_wireframe_options(CommandLine& c, RenderOptions& o) {
  add_schema(c, o, {.group = "Picture", .only = {"wireframe", "wire_width", "wire_color"}});
}

void add_line_options(CommandLine& c, PictureArguments& a) {
  add_schema(c, a.options, {.group = "Picture", .only = {"lines", "line_width", "line_strength", "line_color"}});
}

void add_accessibility_options(CommandLine& c, PictureArguments& a) {
  add_schema(c, a.options, {.group = "Picture", .only = {"accessibility", "bend_light"}});
}

void add_preview_option(CommandLine& c, std::string& file, const std::string& what) {
  c.add_option("--preview", file, "Also draw " + what + " into this PNG").type_name("FILE");
}

}  // namespace sansmesh::cli
