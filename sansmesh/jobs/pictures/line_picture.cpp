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
#include "sansmesh/data/world_points.h"
#include "sansmesh/error.h"
#include "sansmesh/jobs/pictures/color_bar.h"
#include "sansmesh/mesh/edit/tubes.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/render/annotate/picture_notes.h"
#include "sansmesh/render/volume/transfer_presets.h"
#include "sansmesh/render/volume/value_histogram.h"
#include "sansmesh/render_options.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kTubeRadius = 1.0 / 400;  // share of the diagonal of the lines
constexpr double kBothSigns = 0.1;         // share of the larger side that makes the smaller side significant
constexpr double kScaleEnds = 0.01;        // share of the tubes' area clipped at each end of the scale
constexpr double kDrawnStep = 0.5;         // distance between drawn points in radii
constexpr const char* kMagnitude = " (magnitude)";

/// Weights each value by the area of tube with that value, since points crowd where particles are slow or circulate.
/// The scale clips rare values at its ends, which would compress all other colours. `points`: the point of each vertex.
TransferFunction colors_for(const TriangleMesh& mesh, const std::vector<std::uint32_t>& points,
                            const std::vector<double>& values) {
  std::vector<std::pair<double, double>> weighted;  // value, area
  double whole = 0;
  for (const Triangle& t : mesh.triangles) {
    const double area = triangle_area(Vec3(mesh.vertices[t[0]]), Vec3(mesh.vertices[t[1]]), Vec3(mesh.vertices[t[2]]));
    const double value = (values[points[t[0]]] + values[points[t[1]]] + values[points[t[2]]]) / 3;
    if (std::isfinite(value) && area > 0) weighted.emplace_back(value, area), whole += area;
  }
  if (weighted.empty()) throw DataError("no line has two distinct points with values: there is nothing to draw");
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

/// Tubes; the attribute `point` is the index of each vertex's point.
TriangleMesh tubes_around(const PolylineSet& lines, double radius) {
  PolylineSet bare;  // only the point index is needed
  bare.origin = lines.origin, bare.positions = lines.positions, bare.offsets = lines.offsets;
  std::vector<std::uint32_t> numbers(lines.positions.size());
  std::iota(numbers.begin(), numbers.end(), 0u);
  bare.attributes.set("point", std::move(numbers));
  return tubes(bare, {.radius = radius, .sides = 8, .least_step = kDrawnStep * radius});
}

RenderOptions picture_options(const LinePictureOptions& options, const Box3& box) {
  RenderOptions picture = options.picture;
  picture.look.shadows = picture.look.ground = false;
  if (!picture.look.background) picture.look.background = Background::solid({0.93f, 0.94f, 0.95f});
  if (options.default_view)
    if (const auto view = view_of_layer(box, picture.view.up)) picture.view.direction = *view;
  return picture;
}

}  // namespace

const OptionSchema& LinePictureOptions::schema() {
  using O = LinePictureOptions;
  static const OptionRow rows[] = {
      option_group<&O::picture>(RenderOptions::schema().rows),
      option<&O::color_by>({.text = "Quantity: speed, time, vorticity, or an array of `carry` (the length of vectors)",
                            .unit = "name",
                            .from_data = "speed; time for streak and time lines"}),
      option<&O::unit>({.text = "Unit at the scale", .unit = "unit"}),
      option<&O::tube_radius>({.text = "Radius of the tubes",
                               .unit = "length",
                               .from_data = "1/400 of the lines' diagonal",
                               .range = positive()})};
  return option_schema<rows>();
}

void LinePictureOptions::validate(const std::string& default_color) const {
  validate_options(*this);
  picture.validate();
  ValueHistogram widest;  // no range has wider numbers
  widest.lower = -kWidestNumbers, widest.upper = kWidestNumbers;
  check_room_beside(picture,
                    {transfer_function_preset("diverging", widest),
                     with_unit((color_by.empty() ? default_color : color_by) + kMagnitude, unit)},
                    "colour bar");
}

void LinePictureOptions::check_color(const std::vector<std::string>& arrays) const {
  if (color_by.empty() || std::find(arrays.begin(), arrays.end(), color_by) != arrays.end()) return;
  throw ArgumentError(fmt::format("`color_by` {}: the lines have {}; `carry` adds arrays of the data",
                                  printable(color_by, 40), fmt::join(arrays, ", ")));
}

double tube_radius(const PolylineSet& lines, const std::optional<double>& radius) {
  const double chosen = radius.value_or(kTubeRadius * finite_bounds({}, lines.positions).diagonal());
  if (!(chosen > 0)) throw DataError("all points of the lines coincide: there is nothing to draw");
  return chosen;
}

LinePicture line_picture(const PolylineSet& lines, const LinePictureOptions& options, const std::string& default_color,
                         Progress& progress) {
  LinePicture drawn;
  drawn.color_by = options.color_by.empty() ? default_color : options.color_by;
  const Attribute* const array = lines.attributes.find(drawn.color_by);
  if (!array) options.check_color({});
  const Box3 box = finite_bounds({}, lines.positions);
  const std::vector<double> values = sizes_of(*array);
  drawn.radius = tube_radius(lines, options.tube_radius);

  progress.begin("tubes");
  TriangleMesh mesh = tubes_around(lines, drawn.radius);
  drawn.triangles = mesh.triangles.size();
  const std::vector<std::uint32_t>& points = *mesh.attributes.find<std::uint32_t>("point");
  ColorBar bar{colors_for(mesh, points, values),
               with_unit(drawn.color_by + (array->components > 1 ? kMagnitude : ""), options.unit)};
  std::tie(drawn.lower, drawn.upper) = bar.colors.range();
  mesh.colors.resize(points.size());
  parallel_for(0, points.size(), 4096,
               [&](std::size_t v) { mesh.colors[v] = to_bytes(bar.colors.color(values[points[v]])); });

  RenderOptions picture = picture_options(options, box);
  for (const std::uint32_t p : points) {
    bar.ends.below = bar.ends.below || values[p] < drawn.lower;
    bar.ends.above = bar.ends.above || values[p] > drawn.upper;
  }
  reserve_width(picture, bar);
  drawn.image = beside_bar(render_mesh(mesh, picture, progress), bar, picture);
  drawn.made_with = picture;
  return drawn;
}

const ReportSchema& LinePicture::schema() {
  static constexpr ReportRow rows[] = {
      reported<&LinePicture::color_by>({.text = "Array shown by colours"}),
      reported<&LinePicture::lower>({.text = "Value of the first colour", .unit = "unit of the array"}),
      reported<&LinePicture::upper>({.text = "Value of the last colour", .unit = "unit of the array"}),
      reported<&LinePicture::radius>({.text = "Radius of the tubes", .unit = "length"}),
      reported<&LinePicture::triangles>({.text = "Triangles of the tubes"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
