#include "sansmesh/render_options.h"

#include <cmath>
#include <string>

#include "sansmesh/core/check_range.h"
#include "sansmesh/error.h"
#include "sansmesh/render/scene/color_words.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kMostPixels = 16384;
constexpr std::string_view kOverOrOnly[] = {"none", "over", "only"};
constexpr std::string_view kBackgrounds[] = {"gradient", "white", "black", "transparent"};
/// The only accepted values of a flag whose value is optional.
constexpr std::string_view kLengthUnits[] = {"nm", "um",   "µm", "mm",   "cm",    "dm", "m", "km",
                                             "in", "inch", "ft", "foot", "us-ft", "yd", "mi"};

void check_color(const char* name, const Vec3f& color) {
  for (std::size_t k = 0; k < 3; ++k) check_range(name, static_cast<double>(color[k]), 0, 1);
}

/// A background as an option: gradient, transparent, or a colour.
struct BackgroundOption {
  static constexpr auto kind = OptionKind::text;
  static OptionValue get(const Background& background) {
    if (background.kind == Background::Kind::solid) return hex_of_color(background.color);
    return background.kind == Background::Kind::gradient ? "gradient" : "transparent";
  }
  static Background from(const OptionValue& value) {
    const std::string& word = std::get<std::string>(value);
    if (word == "gradient") return {};
    if (word == "transparent") return Background::transparent();
    // Pure white and black, as paper and ink; the named surface colours are less saturated.
    if (word == "white" || word == "black") return Background::solid(word == "white" ? Vec3f{1, 1, 1} : Vec3f{0, 0, 0});
    const auto color = color_of_word(word);
    if (!color)
      throw ArgumentError(ArgumentFault{.field = {},
                                        .value = "'" + printable(word, 60) + "'",
                                        .allowed = "gradient, transparent, '#rrggbb' or a name such as white",
                                        .remedy = {}});
    return Background::solid(*color);
  }
};

}  // namespace

const OptionSchema& PictureView::schema() {
  using O = PictureView;
  static constexpr OptionRow rows[] = {
      option<&O::width>({.text = "Width of the picture", .unit = "pixels", .range = {1, kMostPixels}}),
      option<&O::height>({.text = "Height of the picture", .unit = "pixels", .range = {1, kMostPixels}}),
      option<&O::field_of_view>({.text = "Angle over the shorter side", .unit = "degrees", .range = {1, 120}}),
      option<&O::orthographic>({.text = "Parallel rays: no perspective"}),
      option<&O::look_at>(
          {.text = "Point at the centre of the picture", .from_data = "the centre of the scene", .old_name = "focus"}),
      option<&O::zoom>({.text = "Magnification relative to the picture that shows everything",
                        .unit = "factor",
                        .range = {0.001, 100000}}),
      option<&O::look_radius>({.text = "Instead of `zoom`: a ball of this radius around `look_at` fills the picture",
                               .unit = "length",
                               .range = positive(),
                               .needs = "look_at"}),
      option<&O::clip_box>({.text = "Show only the part in this box, XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

const OptionSchema& PictureLook::schema() {
  using O = PictureLook;
  static constexpr OptionRow rows[] = {
      option<&O::background, BackgroundOption>({.text = "gradient, transparent, or a colour: '#rrggbb' or a name",
                                                .unit = "name",
                                                .from_data = "gradient",
                                                .suggestions = kBackgrounds}),
      option<&O::wireframe>({.text = "Edges of triangles over the surface; `wireframe`=only: the visible edges alone",
                             .choices = kOverOrOnly,
                             .implied = "over"}),
      option<&O::wire_width>(
          {.text = "Width of these edges", .unit = "pixels", .range = {0.1, 50}, .needs = "wireframe"}),
      option<&O::wire_color, ColorOption>(
          {.text = "Colour of these edges, '#rrggbb' or a name", .unit = "color", .needs = "wireframe"}),
      option<&O::lines>(
          {.text = "Draw silhouettes, borders, creases, ridges and valleys alone; `lines`=over: over the lit surface",
           .choices = kOverOrOnly,
           .implied = "only"}),
      option<&O::line_width>({.text = "Width of these lines", .unit = "pixels", .range = {0.1, 50}, .needs = "lines"}),
      option<&O::line_strength>(
          {.text = "Least curvature of ridges and valleys, times the diagonal: smaller values draw more lines",
           .unit = "ratio",
           .range = {0.1, 1e6},
           .needs = "lines"}),
      option<&O::line_color, ColorOption>(
          {.text = "Colour of these lines, '#rrggbb' or a name", .unit = "color", .needs = "lines"}),
      option<&O::accessibility>(
          {.text = "Shade by accessibility: rays of this length, as a share of the diagonal, and curvature",
           .unit = "reach",
           .range = {1e-6, 10},
           .implied = "0.3"}),
      option<&O::curvature_shading>({.text = "Largest relative change of that light by curvature",
                                     .unit = "share",
                                     .range = {0, 1},
                                     .needs = "accessibility",
                                     .old_name = "bend_light"}),
      option<&O::smooth>({.text = "Flat shading: normals are not interpolated", .negative = "flat"}),
      option<&O::shadows>({.text = "No shadows"}),
      option<&O::point_radius>(
          {.text = "Radius of points", .unit = "length", .from_data = "from their spacing", .range = positive()})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

const OptionSchema& PictureQuality::schema() {
  using O = PictureQuality;
  static constexpr OptionRow rows[] = {
      option<&O::samples>({.text = "Rays per pixel in each direction", .range = {1, 8}, .name = "antialiasing"})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

const OptionSchema& PictureAnnotation::schema() {
  using O = PictureAnnotation;
  static constexpr OptionRow rows[] = {option<&O::scale_bar>(
      {.text = "A bar of a round length with its unit, mm, m or in (others as `scale_bar`=UNIT); with `orthographic`",
       .unit = "unit",
       .implied = "",
       .needs = "orthographic",
       .suggestions = kLengthUnits})};
  static constexpr OptionSchema schema{rows};
  return schema;
}

const OptionSchema& RenderOptions::schema() {
  using O = RenderOptions;
  static const OptionRow rows[] = {option_group<&O::view>(PictureView::schema().rows),
                                   option_group<&O::annotation>(PictureAnnotation::schema().rows),
                                   option_group<&O::look>(PictureLook::schema().rows),
                                   option_group<&O::quality>(PictureQuality::schema().rows)};
  static const OptionSchema schema{rows};
  return schema;
}

void RenderOptions::validate() const {
  validate_options(*this);
  check_range("azimuth", view.direction.azimuth, -3600, 3600);
  check_range("elevation", view.direction.elevation, -90, 90);
  if (view.look_at && !is_finite(*view.look_at)) throw ArgumentError("`look_at` must be finite");
  if (!(annotation.input_length > 0 && std::isfinite(annotation.input_length)))
    throw ArgumentError("`input_length` must be positive");
  if (view.clip_box) {
    if (!is_finite(view.clip_box->lower) || !is_finite(view.clip_box->upper))
      throw ArgumentError("`clip_box` must be finite");
    const Vec3 size = view.clip_box->size();
    if (!(size.x > 0 && size.y > 0 && size.z > 0))
      throw ArgumentError("`clip_box` must have an extent: XMIN < XMAX, YMIN < YMAX and ZMIN < ZMAX");
  }
  if (look.accessibility && look.lines == PictureLook::Lines::only)
    throw ArgumentError("`accessibility` needs a lit surface, which `lines` alone does not show: `lines = over`");
  check_color("background", look.effective_background().color);
  check_color("surface_color", look.surface_color);
  check_color("wire_color", look.wire_color);
  check_color("line_color", look.line_color);
  check_range("occlusion_rays", quality.occlusion_rays, 0, 64);
}

void move_from_input(RenderOptions& options, const LocalFrame& frame) {
  if (options.view.look_at) options.view.look_at = frame.from_input(*options.view.look_at);
  if (options.view.look_radius) options.view.look_radius = frame.from_input(*options.view.look_radius);
  options.annotation.input_length *= frame.unit;
  if (options.view.clip_box) options.view.clip_box = frame.from_input(*options.view.clip_box);
}

const OptionSchema& SurfaceRenderOptions::schema() {
  using O = SurfaceRenderOptions;
  static const OptionRow rows[] = {
      option_group<&O::picture>(RenderOptions::schema().rows),
      option<&O::reflection>({.text = "Reflected share of the light", .unit = "share", .range = {0, 1}}),
      option<&O::transmission>({.text = "Transmitted share of the light", .unit = "share", .range = {0, 1}}),
      option<&O::refraction_index>({.text = "Refraction index of the body: 1.33 water, 1.5 glass",
                                    .unit = "ratio",
                                    .range = {1, 4},
                                    .needs = "transmission"}),
      option<&O::bounces>({.text = "Mirrored and refracted rays in sequence", .range = {1, 16}}),
      option<&O::exact_shadows>({.text = "Shadows by rays to the surface itself: slow"}),
      option<&O::plain>(
          {.text = "Quick: one ray per pixel, no shadows, no ground", .name = "quick", .old_name = "plain"})};
  static const OptionSchema schema{rows};
  return schema;
}

void SurfaceRenderOptions::validate() const {
  picture.validate();
  validate_options(*this);
  if (reflection + transmission > 1 + 1e-9)
    throw ArgumentError("`reflection` + `transmission` must be at most 1, not " +
                        std::to_string(reflection + transmission));
}

}  // namespace sansmesh::inline v1
