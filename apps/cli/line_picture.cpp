#include "line_picture.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "sansmesh/core/box.h"
#include "sansmesh/core/error.h"
#include "sansmesh/io/io.h"
#include "sansmesh/mesh/tubes.h"
#include "sansmesh/render/mesh_picture.h"
#include "sansmesh/render/picture_notes.h"
#include "sansmesh/render/transfer_presets.h"
#include "sansmesh/render/value_histogram.h"

namespace sansmesh::cli {
namespace {

constexpr double kRadius = 1.0 / 400;  // of the diagonal of the lines
constexpr double kBothSigns = 0.1;     // of the larger side, on the smaller one
constexpr double kScaleEnds = 0.02;    // of the lines' length, at each end of the scale
constexpr double kStep = 0.5;          // between points that are drawn, in radii
/// Pixels that are left for the lines beside the colour bar, at least.
constexpr int kLeastBesideBar = 100;

const Attribute& array_of(const PolylineSet& lines, const std::string& name) {
  if (const Attribute* const a = lines.attributes.find(name)) return *a;
  std::string names;
  for (const Attribute& a : lines.attributes) names += (names.empty() ? "" : ", ") + a.name;
  throw ArgumentError(
      fmt::format("--color-by {}: the lines have {}; --carry adds arrays of the data", printable(name, 40), names));
}

/// A number for each row: of vectors their length.
std::vector<double> numbers_of(const Attribute& a) {
  std::vector<double> values(a.rows());
  for (std::size_t i = 0; i < values.size(); ++i) {
    double square = 0;
    for (std::size_t c = 0; c < a.components; ++c)
      square += a.number(i * a.components + c) * a.number(i * a.components + c);
    values[i] = a.components == 1 ? a.number(i) : std::sqrt(square);
  }
  return values;
}

/// Each value counts as much as the line is long there: where particles are slow their points crowd. The ends of the
/// scale leave out what few places have, which would take the colours from all others.
TransferFunction colors_for(const std::vector<double>& values, const PolylineSet& lines) {
  std::vector<std::pair<double, double>> weighted;  // value, length
  double whole = 0;
  for (std::size_t line = 0; line < lines.size(); ++line)
    for (std::size_t i = lines.offsets[line]; i + 1 < lines.offsets[line + 1]; ++i) {
      const double length = norm(Vec3(lines.positions[i + 1]) - Vec3(lines.positions[i]));
      const double value = 0.5 * (values[i] + values[i + 1]);
      if (std::isfinite(value) && length > 0) weighted.emplace_back(value, length), whole += length;
    }
  if (weighted.empty()) throw DataError("no line has two places and values there: there is nothing to draw");
  std::sort(weighted.begin(), weighted.end());
  ValueHistogram h;
  h.lower = weighted.front().first, h.upper = weighted.back().first;
  double so_far = 0;
  for (const auto& [value, length] : weighted) {
    if (so_far <= kScaleEnds * whole) h.lower = value;
    if (so_far <= (1 - kScaleEnds) * whole) h.upper = value;
    so_far += length;
  }
  const bool signs =
      h.lower < 0 && h.upper > 0 && std::min(-h.lower, h.upper) > kBothSigns * std::max(-h.lower, h.upper);
  return transfer_function_preset(signs ? "diverging" : "flow", h);
}

}  // namespace

void LinePictureArguments::check() const {
  if (file.empty()) {
    require(color_by.empty() && !radius && background.empty() && !picture.has_view(),
            "--color-by, --tube-radius, --background and views need --preview");
    return;
  }
  require(!radius || (std::isfinite(*radius) && *radius > 0), "--tube-radius must be positive");
  picture.chosen().validate();
  check_writable(file, "image");
}

LinePicture draw_lines(const PolylineSet& lines, const LinePictureArguments& a, const std::string& usual,
                       Progress& progress) {
  LinePicture drawn;
  drawn.color_by = a.color_by.empty() ? usual : a.color_by;
  const Attribute& array = array_of(lines, drawn.color_by);
  Box3 box;
  for (const Vec3f& p : lines.positions)
    if (is_finite(p)) box.extend(Vec3(p));
  const std::vector<double> values = numbers_of(array);
  const TransferFunction colors = colors_for(values, lines);
  std::tie(drawn.lower, drawn.upper) = colors.range();
  drawn.radius = a.radius.value_or(kRadius * box.diagonal());
  if (!(drawn.radius > 0)) throw DataError("all points of the lines are in one place: there is nothing to draw");

  progress.begin("tubes");
  PolylineSet bare;  // of all attributes only the colours are seen
  bare.origin = lines.origin, bare.positions = lines.positions, bare.offsets = lines.offsets;
  std::vector<std::uint8_t> bytes(3 * values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Vec3f c = colors.color(values[i]);
    for (std::size_t k = 0; k < 3; ++k) bytes[3 * i + k] = to_byte(c[k]);
  }
  bare.attributes.set("color", std::move(bytes), 3);
  TriangleMesh mesh = tubes(bare, {.radius = drawn.radius, .sides = 8, .least_step = kStep * drawn.radius});
  if (mesh.triangles.empty()) throw DataError("no line has two points: there is nothing to draw");
  drawn.triangles = mesh.triangles.size();
  const std::vector<std::uint8_t>& of_vertices = *mesh.attributes.find<std::uint8_t>("color");
  mesh.colors.resize(mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.colors.size(); ++v)
    for (std::size_t k = 0; k < 3; ++k) mesh.colors[v][k] = of_vertices[3 * v + k];

  RenderOptions look = a.picture.chosen();
  // Colours are to be read: no shadow on the ground or on other lines.
  look.background = RenderOptions::Background::solid;
  look.background_color = {0.93f, 0.94f, 0.95f};
  look.shadows = look.ground = false;
  if (!a.background.empty()) set_background(look, a.background);
  if (a.background == "gradient") look.background = RenderOptions::Background::gradient;
  if (!a.picture.has_view())
    if (const auto view = view_of_layer(box, look.up)) look.view = *view;
  const std::string title = drawn.color_by + (array.components > 1 ? " (magnitude)" : "");
  const int bar = value_bar_width(look.height, colors, title);
  if (bar > 0 && look.width < bar + kLeastBesideBar)
    throw ArgumentError(fmt::format("--width {} is too narrow: a picture {} high takes {} with its colour bar, or more",
                                    look.width, look.height, bar + kLeastBesideBar));
  look.width -= bar;
  drawn.image = beside_value_bar(render_mesh(mesh, look, progress), colors, title);
  return drawn;
}

void add_line_picture(CommandLine& c, LinePictureArguments& a) {
  add_preview_option(c, a.file, "the lines as tubes");
  const char* const group = "Picture";
  c.add_option("--color-by", a.color_by,
               "speed, time, vorticity, or an array of --carry; of vectors their length [speed; of streak and time "
               "lines time]")
      .type_name("NAME")
      .group(group);
  c.add_option("--tube-radius", a.radius, "Of the tubes [1/400 of the lines' diagonal]")
      .type_name("LENGTH")
      .group(group);
  c.add_option("--background", a.background, "gradient, white, black or transparent [light gray]")
      .one_of({"gradient", "white", "black", "transparent"})
      .type_name("NAME")
      .group(group);
  add_picture_options(c, a.picture);
}

}  // namespace sansmesh::cli
