#include "sansmesh/pictures.h"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <utility>

#include "sansmesh/box.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/jobs/color_bar.h"
#include "sansmesh/mesh/edit/tubes.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/render/annotate/picture_notes.h"
#include "sansmesh/render/volume/transfer_presets.h"
#include "sansmesh/render/volume/value_histogram.h"
#include "sansmesh/render_options.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kTubeRadius = 1.0 / 400;  // of the diagonal of the lines
constexpr double kBothSigns = 0.1;         // of the larger side, on the smaller one
constexpr double kScaleEnds = 0.01;        // of the tubes' area, at each end of the scale
constexpr double kDrawnStep = 0.5;         // between points that are drawn, in radii
constexpr const char* kMagnitude = " (magnitude)";

/// Each value counts as much as it has of the tubes, whose vertices are of these points: where particles are slow or
/// turn round and round their points crowd. The ends of the scale leave out what little of the tubes has, which would
/// take the colours from all others.
TransferFunction colors_for(const TriangleMesh& mesh, const std::vector<std::uint32_t>& points,
                            const std::vector<double>& values) {
  std::vector<std::pair<double, double>> weighted;  // value, area
  double whole = 0;
  for (const Triangle& t : mesh.triangles) {
    const double area = triangle_area(Vec3(mesh.vertices[t[0]]), Vec3(mesh.vertices[t[1]]), Vec3(mesh.vertices[t[2]]));
    const double value = (values[points[t[0]]] + values[points[t[1]]] + values[points[t[2]]]) / 3;
    if (std::isfinite(value) && area > 0) weighted.emplace_back(value, area), whole += area;
  }
  if (weighted.empty()) throw DataError("no line has two places and values there: there is nothing to draw");
  std::sort(weighted.begin(), weighted.end());
  ValueHistogram h;
  h.lower = weighted.front().first, h.upper = weighted.back().first;
  double so_far = 0;
  for (const auto& [value, area] : weighted) {
    if (so_far <= kScaleEnds * whole) h.lower = value;
    if (so_far <= (1 - kScaleEnds) * whole) h.upper = value;
    so_far += area;
  }
  const bool signs =
      h.lower < 0 && h.upper > 0 && std::min(-h.lower, h.upper) > kBothSigns * std::max(-h.lower, h.upper);
  return transfer_function_preset(signs ? "diverging" : "flow", h);
}

/// In coordinates relative to the origin of the lines.
Box3 box_of_lines(const PolylineSet& lines) {
  Box3 box;
  for (const Vec3f& p : lines.positions)
    if (is_finite(p)) box.extend(Vec3(p));
  return box;
}

/// The tubes; `point` is the point of the lines that a vertex is of.
TriangleMesh tubes_around(const PolylineSet& lines, double radius) {
  PolylineSet bare;  // which point a vertex is of is all that is needed
  bare.origin = lines.origin, bare.positions = lines.positions, bare.offsets = lines.offsets;
  std::vector<std::uint32_t> numbers(lines.positions.size());
  std::iota(numbers.begin(), numbers.end(), 0u);
  bare.attributes.set("point", std::move(numbers));
  return tubes(bare, {.radius = radius, .sides = 8, .least_step = kDrawnStep * radius});
}

RenderOptions look_for(const LinePictureOptions& options, const Box3& box) {
  RenderOptions picture = options.picture;
  picture.look.shadows = picture.look.ground = false;
  if (!picture.look.background) picture.look.background = Background::solid({0.93f, 0.94f, 0.95f});
  if (options.any_view)
    if (const auto view = view_of_layer(box, picture.view.up)) picture.view.direction = *view;
  return picture;
}

}  // namespace

const OptionSchema& LinePictureOptions::schema() {
  using O = LinePictureOptions;
  static const OptionRow rows[] = {
      option_group<&O::picture>(RenderOptions::schema().rows),
      option<&O::color_by>({.text = "speed, time, vorticity, or an array of `carry`; of vectors their length",
                            .unit = "name",
                            .from_data = "speed; of streak and time lines time"}),
      option<&O::unit>({.text = "Of what colours are by, at the scale", .unit = "unit"}),
      option<&O::tube_radius>({.text = "Of the tubes",
                               .unit = "length",
                               .from_data = "1/400 of the lines' diagonal",
                               .range = positive()})};
  static const OptionSchema schema{rows};
  return schema;
}

void LinePictureOptions::validate(const std::string& usual) const {
  validate_options(*this);
  picture.validate();
  ValueHistogram widest;  // no numbers are wider than those of such a range
  widest.lower = -kWidestNumbers, widest.upper = kWidestNumbers;
  const int bar = value_bar_width(picture.view.height, transfer_function_preset("diverging", widest),
                                  with_unit((color_by.empty() ? usual : color_by) + kMagnitude, unit));
  check_room_beside(picture, bar, "colour bar");
}

void LinePictureOptions::check_color(const std::vector<std::string>& arrays) const {
  if (color_by.empty() || std::find(arrays.begin(), arrays.end(), color_by) != arrays.end()) return;
  throw ArgumentError(fmt::format("`color_by` {}: the lines have {}; `carry` adds arrays of the data",
                                  printable(color_by, 40), fmt::join(arrays, ", ")));
}

double tube_radius(const PolylineSet& lines, const std::optional<double>& radius) {
  const double chosen = radius.value_or(kTubeRadius * box_of_lines(lines).diagonal());
  if (!(chosen > 0)) throw DataError("all points of the lines are in one place: there is nothing to draw");
  return chosen;
}

LinePicture line_picture(const PolylineSet& lines, const LinePictureOptions& options, const std::string& usual,
                         Progress& progress) {
  LinePicture drawn;
  drawn.color_by = options.color_by.empty() ? usual : options.color_by;
  const Attribute* const array = lines.attributes.find(drawn.color_by);
  if (!array) options.check_color({});
  const Box3 box = box_of_lines(lines);
  const std::vector<double> values = sizes_of(*array);
  drawn.radius = tube_radius(lines, options.tube_radius);

  progress.begin("tubes");
  TriangleMesh mesh = tubes_around(lines, drawn.radius);
  drawn.triangles = mesh.triangles.size();
  const std::vector<std::uint32_t>& points = *mesh.attributes.find<std::uint32_t>("point");
  const TransferFunction colors = colors_for(mesh, points, values);
  std::tie(drawn.lower, drawn.upper) = colors.range();
  mesh.colors.resize(points.size());
  parallel_for(0, points.size(), 4096, [&](std::size_t v) {
    const Vec3f c = colors.color(values[points[v]]);
    mesh.colors[v] = {to_byte(c.x), to_byte(c.y), to_byte(c.z)};
  });

  RenderOptions picture = look_for(options, box);
  const std::string title = with_unit(drawn.color_by + (array->components > 1 ? kMagnitude : ""), options.unit);
  picture.view.width -= value_bar_width(picture.view.height, colors, title);
  BarEnds ends;
  for (const std::uint32_t p : points) {
    ends.below = ends.below || values[p] < drawn.lower;
    ends.above = ends.above || values[p] > drawn.upper;
  }
  const Image paper = paper_beside(picture);
  drawn.image = beside_value_bar(render_mesh(mesh, picture, progress), colors, title, {}, &paper, ends);
  drawn.made_with = picture;
  return drawn;
}

namespace {

constexpr ReportRow kLinePictureRows[] = {
    reported<&LinePicture::color_by>({.text = "Array that the colours show"}),
    reported<&LinePicture::lower>({.text = "Value of the first colour", .unit = "unit of the array"}),
    reported<&LinePicture::upper>({.text = "Value of the last colour", .unit = "unit of the array"}),
    reported<&LinePicture::radius>({.text = "Radius of the tubes", .unit = "length"}),
    reported<&LinePicture::triangles>({.text = "Triangles that were drawn"})};

}  // namespace

const ReportSchema& LinePicture::schema() {
  static constexpr ReportSchema schema{kLinePictureRows};
  return schema;
}

}  // namespace sansmesh::inline v1
