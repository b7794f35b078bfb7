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
#include "sansmesh/render/color_space.h"
#include "sansmesh/render/picture_crop.h"

namespace sansmesh::cli {
namespace {

constexpr const char* kContent = "content";

constexpr std::array<std::pair<std::string_view, std::string_view>, 13> kColorWords{{{"red", "#d62828"},
                                                                                     {"orange", "#f08c1e"},
                                                                                     {"yellow", "#f2d21f"},
                                                                                     {"green", "#2f9e44"},
                                                                                     {"cyan", "#22b8cf"},
                                                                                     {"blue", "#2f6fde"},
                                                                                     {"purple", "#8e4ec6"},
                                                                                     {"magenta", "#d6409f"},
                                                                                     {"brown", "#8d5a34"},
                                                                                     {"white", "#f5f5f5"},
                                                                                     {"gray", "#8c9199"},
                                                                                     {"silver", "#c6cad0"},
                                                                                     {"black", "#22252a"}}};

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

std::optional<Vec3f> color_of_word(const std::string& word) {
  for (const auto& [name, hex] : kColorWords)
    if (name == word) return color_of_hex(hex);
  return color_of_hex(word);
}

std::string color_words() {
  std::string known;
  for (const auto& color : kColorWords) known += (known.empty() ? "" : ", ") + std::string(color.first);
  return known;
}

bool PictureArguments::any() const {
  const RenderOptions usual;
  return options.wireframe != usual.wireframe || options.wire_width != usual.wire_width ||
         options.wire_color != usual.wire_color || has_view() || !crop.empty() || z_up ||
         options.width != usual.width || options.height != usual.height ||
         options.field_of_view != usual.field_of_view || options.orthographic || options.scale_bar || options.look_at ||
         options.zoom != usual.zoom || options.look_radius || options.clip_box;
}

RenderOptions PictureArguments::chosen() const {
  RenderOptions o = options;
  const RenderOptions usual;
  if (o.wireframe == RenderOptions::Wireframe::none &&
      (o.wire_width != usual.wire_width || o.wire_color != usual.wire_color))
    throw ArgumentError("--wire-width and --wire-color need --wireframe");
  if (o.lines == RenderOptions::Lines::none &&
      (o.line_width != usual.line_width || line_strength || o.line_color != usual.line_color))
    throw ArgumentError("--line-width, --line-strength and --line-color need --lines");
  if (!o.accessibility && bend_light) throw ArgumentError("--bend-light needs --accessibility");
  if (o.accessibility && o.lines == RenderOptions::Lines::only)
    throw ArgumentError("--accessibility is light, which --lines alone does not show: --lines=over");
  o.line_strength = line_strength.value_or(usual.line_strength);
  o.bend_light = bend_light.value_or(usual.bend_light);
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

std::string frame_name(const std::string& output, int frame) {
  const std::filesystem::path path(output);
  return (path.parent_path() / fmt::format("{}_{:03}{}", path.stem().string(), frame, path.extension().string()))
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
  RenderOptions& o = a.options;
  c.add_option("--width", o.width, "Pixels, 1..16384 [1280]").type_name("PIXELS").group(group);
  c.add_option("--height", o.height, "Pixels, 1..16384 [960]").type_name("PIXELS").group(group);
  c.add_option("--view", a.view, "front, back, left, right, top, bottom or iso")
      .one_of({"front", "back", "left", "right", "top", "bottom", "iso"})
      .type_name("NAME")
      .group(group);
  c.add_option("--azimuth", a.azimuth, "Degrees around the up axis; 0: the front [35]")
      .type_name("DEGREES")
      .group(group);
  c.add_option("--elevation", a.elevation, "Degrees above the horizon [20]").type_name("DEGREES").group(group);
  c.add_flag("--z-up", a.z_up, "The z axis points up, not y").group(group);
  c.add_option("--field-of-view", o.field_of_view, "Angle over the shorter side, 1..120 [30]")
      .type_name("DEGREES")
      .group(group);
  c.add_flag("--orthographic", o.orthographic, "Parallel rays: no perspective").group(group);
  c.add_option_function(
       "--scale-bar", [&o](const std::string& unit) { o.scale_bar = unit; },
       "With --orthographic: a bar of a round length, and the unit's name, mm, m or in (others as --scale-bar=UNIT)")
      .type_name("UNIT")
      .without_value("",
                     {"nm", "um", "µm", "mm", "cm", "dm", "m", "km", "in", "inch", "ft", "foot", "us-ft", "yd", "mi"})
      .group(group);
  c.add_option_function(
       "--focus,--look-at",
       [&o](const std::vector<double>& x) {
         o.look_at = Vec3{x[0], x[1], x[2]};
       },
       "Place in the middle of the picture [that of what is seen]")
      .numbers(3)
      .type_name("X,Y,Z")
      .group(group);
  c.add_option("--zoom", o.zoom, "So many times as large as what shows everything [1]")
      .type_name("FACTOR")
      .group(group);
  c.add_option("--look-radius", o.look_radius, "With --look-at, for --zoom: what is so far around fills the picture")
      .type_name("LENGTH")
      .group(group);
  c.add_option_function(
       "--clip-box",
       [&o](const std::vector<double>& v) {
         o.clip_box = Box3{{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
       },
       "Show only what lies in this box, XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX")
      .numbers(6)
      .type_name("BOX")
      .group(group);
  c.add_option("--crop", a.crop,
               "Part of the picture, LEFT,TOP,WIDTH,HEIGHT in pixels [no value: what is not background]")
      .type_name("PART")
      .without_value(kContent)
      .group(group);
}

void add_wireframe_options(CommandLine& c, RenderOptions& o) {
  using Wireframe = RenderOptions::Wireframe;
  const char* const group = "Picture";
  c.add_option_function(
       "--wireframe",
       [&o](const std::string& word) { o.wireframe = word == "only" ? Wireframe::only : Wireframe::over; },
       "Edges of triangles: over the surface, or only these without hidden ones, as --wireframe=only [no value: over]")
      .one_of({"over", "only"})
      .type_name("HOW")
      .without_value("over")
      .group(group);
  c.add_option("--wire-width", o.wire_width, "Of their lines, 0.1..50 [1]").type_name("PIXELS").group(group);
  c.add_option_function(
       "--wire-color",
       [&o](const std::string& word) {
         const auto color = color_of_word(word);
         if (!color) throw ValueError("must be '#rrggbb' or a name such as blue, not " + word);
         o.wire_color = *color;
       },
       "Of their lines, '#rrggbb' or a name [almost black]")
      .type_name("COLOR")
      .group(group);
}

void add_line_options(CommandLine& c, PictureArguments& a) {
  RenderOptions& o = a.options;
  using Lines = RenderOptions::Lines;
  const char* const group = "Picture";
  c.add_option_function(
       "--lines", [&o](const std::string& word) { o.lines = word == "over" ? Lines::over : Lines::only; },
       "Draw silhouettes, borders, creases, ridges and valleys: only these, or over the lit surface, as --lines=over "
       "[no value: only]")
      .one_of({"only", "over"})
      .type_name("HOW")
      .without_value("only")
      .group(group);
  c.add_option("--line-width", o.line_width, "Of these lines, 0.1..50 [1.5]").type_name("PIXELS").group(group);
  c.add_option("--line-strength", a.line_strength,
               "Ridges and valleys from this curvature times the diagonal on: less is more of them [20]")
      .type_name("RATIO")
      .group(group);
  c.add_option_function(
       "--line-color",
       [&o](const std::string& word) {
         const auto color = color_of_word(word);
         if (!color) throw ValueError("must be '#rrggbb' or a name such as blue, not " + word);
         o.line_color = *color;
       },
       "Of these lines, '#rrggbb' or a name [almost black]")
      .type_name("COLOR")
      .group(group);
}

void add_accessibility_options(CommandLine& c, PictureArguments& a) {
  RenderOptions& o = a.options;
  const char* const group = "Picture";
  c.add_option_function(
       "--accessibility",
       [&o](const std::string& word) {
         const auto reach = number_in(word);
         if (!reach || !(*reach >= 1e-6 && *reach <= 10))
           throw ValueError("must be a length over the diagonal, 1e-6..10, not " + printable(word, 60));
         o.accessibility = true, o.exposure_reach = *reach;
       },
       "Light is how open a place is: by rays around it, so long over the diagonal, and by curvature [no value: 0.3]")
      .type_name("REACH")
      .without_value("0.3")
      .group(group);
  c.add_option("--bend-light", a.bend_light, "Share of that light that curvature gives and takes, 0..1 [0.3]")
      .type_name("SHARE")
      .group(group);
}

void add_preview_option(CommandLine& c, std::string& file, const std::string& what) {
  c.add_option("--preview", file, "Also draw " + what + " into this PNG").type_name("FILE");
}

}  // namespace sansmesh::cli
