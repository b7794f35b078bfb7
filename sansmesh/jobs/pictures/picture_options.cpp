#include "sansmesh/pictures.h"

#include <fmt/core.h>

#include <algorithm>

#include "sansmesh/error.h"
#include "sansmesh/jobs/given_options.h"
#include "sansmesh/jobs/pictures/picture_checks.h"
#include "sansmesh/model/surface_method.h"
#include "sansmesh/render/scene/color_words.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::string_view kRayStarts[] = {"march", "stored"};
constexpr double kMostSplatsAsked = 1e8, kMostPictures = 1e5;

/// Two numbers LOW,HIGH, or R for -R,R.
struct ColorRangeWords {
  static constexpr auto kind = OptionKind::numbers;
  static constexpr int count = 0;
  static OptionValue get(const std::pair<double, double>& v) { return std::vector<double>{v.first, v.second}; }
  static std::pair<double, double> from(const OptionValue& value) {
    const auto& v = std::get<std::vector<double>>(value);
    if (v.size() == 1) return {-v[0], v[0]};
    if (v.size() != 2)
      throw ArgumentError(ArgumentFault{
          .field = {}, .value = std::to_string(v.size()) + " numbers", .allowed = "a number or LOW,HIGH"});
    return {v[0], v[1]};
  }
};

void check_color_words(const std::vector<std::string>& words) {
  for (const std::string& word : words)
    if (word != kAutoColor && word != kOwnColor && !color_of_word(word))
      throw ArgumentError(ArgumentFault{
          .field = "color",
          .value = "'" + printable(word, 40) + "'",
          .allowed = fmt::format("{}, '#rrggbb', {} (the file's) or {}", color_words(), kOwnColor, kAutoColor)});
}

/// In pictures with only feature lines, surfaces have neither light nor colour.
void check_lines_alone(const PictureOptions& o) {
  if (o.look.picture.look.lines != PictureLook::Lines::only) return;
  refuse({{"color", !o.colors.empty()},
          {"color_by", !o.color_by.empty()},
          {"name", !o.names.empty()},
          {"wireframe", o.look.picture.look.wireframe != PictureLook::Wireframe::none},
          {"reflection", o.look.reflection != 0},
          {"transmission", o.look.transmission != 0},
          {"exact_shadows", o.look.exact_shadows}},
         "is for visible surfaces: use `lines = over`");
}

void check_translucent(const PictureOptions& o) {
  if (!o.translucent()) return;
  if (o.surface) throw ArgumentError("`opacity` is for meshes, points and functions: not with `surface`");
  if (!o.color_by.empty()) throw ArgumentError("`color_by` does not go with `opacity`");
  refuse({{"lines", o.look.picture.look.lines != PictureLook::Lines::none},
          {"accessibility", o.look.picture.look.accessibility.has_value()},
          {"quick", o.look.plain},
          {"exact_shadows", o.look.exact_shadows}},
         "is for opaque objects: not with `opacity` below 1");
}

void check_splats_and_rays(const PictureOptions& o) {
  const SurfaceRenderOptions& s = o.look;
  if (s.plain && s.picture.look.accessibility) throw ArgumentError("`quick` and `accessibility` exclude each other");
  if (s.plain)
    refuse({{"antialiasing",
             s.picture.quality.samples != RenderOptions().quality.samples && s.picture.quality.samples != 1},
            {"exact_shadows", s.exact_shadows}},
           "excludes `quick`, which has one ray per pixel and no shadows");
  if (o.splats)
    refuse({{"opacity", o.translucent()},
            {"reflection", s.reflection != 0},
            {"transmission", s.transmission != 0},
            {"exact_shadows", s.exact_shadows}},
           "does not apply to `splats`");
  const bool projection = o.surface && !o.splats && surface_method(o.surface->method).projects;
  if (o.rays && !projection) throw ArgumentError("`rays` needs `surface` levin, alexa or curvature, and no `splats`");
}

void check_values(const PictureOptions& o) {
  const bool by_confidence = o.color_by == kConfidence;
  if (o.color_range && (o.color_by.empty() || by_confidence))
    throw ArgumentError("`color_range` needs `color_by` with an attribute or curvature");
  if (o.color_range && !(o.color_range->first < o.color_range->second))
    throw ArgumentError("`color_range` must be LOW,HIGH, or one positive number");
  if (!o.unit.empty() && (o.color_by.empty() || by_confidence || !o.bar))
    throw ArgumentError("`unit` is for the colour bar of `color_by`");
  if (!o.color_by.empty() && !o.colors.empty()) throw ArgumentError("`color` and `color_by` exclude each other");
}

}  // namespace

bool PictureOptions::translucent() const {
  return std::any_of(opacities.begin(), opacities.end(), [](double opacity) { return opacity < 1; });
}

const OptionSchema& PictureOptions::schema() {
  using O = PictureOptions;
  static constexpr OptionRow rows[] = {
      option<&O::colors>({.text = "Colour of the first file, then of the second, …: '#rrggbb', red, blue, …, own "
                                  "(the file's) or auto",
                          .unit = "color",
                          .from_data = "own if there are any",
                          .name = "color"}),
      option<&O::opacities>({.text = "Opacity of the first file, then of the second, …",
                             .unit = "share",
                             .from_data = "1",
                             .range = {0, 1},
                             .name = "opacity"}),
      option<&O::names>({.text = "Name of the first file in the legend, then of the second, …",
                         .unit = "text",
                         .from_data = "the files'",
                         .name = "name"}),
      option<&O::legend>({.text = "Omit the legend"}),
      option<&O::color_by>({.text = "Attribute of the vertices or points (the length of vectors); with `surface` "
                                    "mean, gaussian, k1 or k2 curvature (red convex, blue concave); confidence (red "
                                    "far from samples)",
                            .unit = "quantity"}),
      option<&O::color_range, ColorRangeWords>(
          {.text = "Values at the ends of the colour bar: LOW,HIGH, or R for -R,R; for curvatures R, in "
                   "1/length or, for gaussian, 1/length²",
           .from_data = "from data",
           .old_name = "value_range"}),
      option<&O::bar>({.text = "Omit the colour bar"}),
      option<&O::unit>(
          {.text = "Unit at the colour bar: of the attribute, or of lengths in curvatures", .unit = "unit"}),
      option<&O::rays>({.text = "levin, alexa, curvature: march through the balls around the samples, or start from "
                                "polynomials stored with them",
                        .unit = "choice",
                        .from_data = "march",
                        .choices = kRayStarts}),
      option<&O::splats>({.text = "Draw this number of evenly spread points as blended splats, of `surface` or the "
                                  "recommended surface; 0: as many as samples",
                          .unit = "count",
                          .range = {0, kMostSplatsAsked},
                          .implied = "0"}),
      option<&O::frames>({.text = "Number of pictures of a turntable: NAME_000.png, NAME_001.png, …",
                          .unit = "count",
                          .range = {1, kMostPictures}})};
  return option_schema<rows>();
}

void PictureOptions::validate() const {
  look.validate();
  validate_options(*this);
  if (surface) surface->validate();
  check_color_words(colors);
  check_translucent(*this);
  check_splats_and_rays(*this);
  check_lines_alone(*this);
  check_values(*this);
}

}  // namespace sansmesh::inline v1
