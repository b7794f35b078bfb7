#include "sansmesh/attribute_table.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/inspect.h"
#include "sansmesh/partition/partition_data.h"
#include "sansmesh/points.h"
#include "sansmesh/points/normals/given_normals.h"
#include "sansmesh/points/statistics/noise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sansmesh/core/number_words.h"
#include "sansmesh/data/reference_system.h"
#include "sansmesh/error.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/mesh/repair/sewn_mesh.h"
#include "sansmesh/mesh/topology_words.h"
#include "sansmesh/points/cleaning/duplicates.h"
#include "sansmesh/points/cleaning/point_classes.h"
#include "sansmesh/points/orientation/orient_words.h"
#include "sansmesh/points/shape/cloud_shape.h"
#include "sansmesh/points/statistics/spacing.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {
namespace {

const char* shape_words(CloudShape shape) {
  switch (shape) {
    case CloudShape::empty:
      return "empty";
    case CloudShape::point:
      return "a point";
    case CloudShape::line:
      return "a line";
    case CloudShape::plane:
      return "a plane";
    case CloudShape::volume:
      return "a volume";
  }
  return "";
}

/// Shape of a cloud as text, or the distance between its parts if that hides their shape.
std::string span_words(const PointSet& points) {
  if (const auto parts = find_far_parts(points)) return fmt::format("parts {:.3g} apart", parts->apart);
  return shape_words(classify_shape(points));
}

std::optional<std::pair<double, double>> range_of(const Attribute& a, std::size_t component) {
  std::optional<std::pair<double, double>> range;
  for (std::size_t i = component; i < a.size(); i += a.components) {
    const double v = a.number(i);
    if (!std::isfinite(v)) continue;
    if (!range) range = {v, v};
    range->first = std::min(range->first, v), range->second = std::max(range->second, v);
  }
  return range;
}

void describe(const AttributeTable& table, std::string_view of, std::vector<AttributeInfo>& described) {
  for (const Attribute& a : table) {
    AttributeInfo info{a.name, of, a.type(), {}};
    for (std::size_t c = 0; c < a.components; ++c) info.ranges.push_back(range_of(a, c));
    described.push_back(std::move(info));
  }
}

}  // namespace

CloudInfo info(const PointSet& points, Progress& progress) {
  progress.begin("measure");
  CloudInfo info;
  const Box3f box = bounds(points);
  info.points = points.size();
  info.duplicates = points.size() - count_unique(points);
  info.box = LocalFrame{points.origin}.to_input(box);
  info.size = Vec3(box.size());
  info.spans = span_words(points);
  info.spacing = estimate_spacing(points);
  info.noise = measure_noise(points);
  info.normals = judge_normals(points, info.noise.deviation);
  info.orient_by = first_known_orientation(points, info.noise.deviation);
  info.colors = points.has_colors();
  info.reference = points.reference;
  info.scanners = points.scanners.size();
  describe(points.attributes, "point", info.attributes);
  describe(points.triangle_attributes, "triangle", info.attributes);
  if (const Attribute* const classes = find_point_classes(points)) info.classes = count_point_classes(*classes);
  info.triangles = points.triangles.size();
  if (info.triangles > 0) info.mesh = sewn_topology(to_mesh(points));
  return info;
}

FunctionInfo info(const SurfaceFunction& described) {
  const FittedFunction& function = described.fitted();
  const PartitionReport& r = function.field.report();
  const LocalFrame& frame = function.frame;
  FunctionInfo info;
  info.fits = r.functions;
  info.fits_of_degree = r.functions_of_degree;
  info.creased = r.creased;
  info.depth = r.depth;
  info.open_share = r.area > 0 ? std::min(1.0, r.open_area / r.area) : 0;
  info.mean_winding_number = r.mean_winding_number;
  info.samples = function.samples->size();
  info.colors = function.samples->has_colors();
  info.cube = frame.to_input(function.field.bounds());
  info.spacing = frame.to_input(r.spacing);
  info.deviation = frame.to_input(r.noise);
  info.accuracy = frame.to_input(r.accuracy);
  info.history = function.history;
  info.paper = function.paper;
  return info;
}

const ReportSchema& FunctionInfo::schema() {
  static constexpr ReportRow rows[] = {
      reported<&FunctionInfo::fits>({.text = "Local fits"}),
      reported<&FunctionInfo::fits_of_degree>({.text = "Local fits of degree 0 to 4"}),
      reported<&FunctionInfo::creased>({.text = "Local fits with a crease"}),
      reported<&FunctionInfo::open_share>({.text = "Share of the surface that bounds no solid", .unit = "share"}),
      reported<&FunctionInfo::mean_winding_number>(
          {.name = "winding_number_behind", .text = "Mean winding number behind the samples"}),
      reported<&FunctionInfo::depth>({.text = "Deepest level of the tree"}),
      reported<&FunctionInfo::samples>({.text = "Samples that were kept"}),
      reported<&FunctionInfo::spacing>({.text = "Spacing of the samples", .unit = "length"}),
      reported<&FunctionInfo::deviation>(
          {.text = "Root mean square distance of the samples from the surface", .unit = "length"}),
      reported<&FunctionInfo::accuracy>({.text = "Expected error of the surface", .unit = "length"}),
      reported<&FunctionInfo::cube>({.text = "Corners of the cube of the tree", .unit = "length"}),
      reported<&FunctionInfo::paper>({.text = "Construction of blocks, for fits by a published method"}),
      reported<&FunctionInfo::history>({.text = "Edits of the function"})};
  return report_schema<rows>();
}

namespace {

std::vector<std::optional<double>> ends_of(const AttributeInfo& info, bool upper) {
  std::vector<std::optional<double>> ends;
  ends.reserve(info.ranges.size());
  for (const auto& range : info.ranges)
    ends.push_back(range ? std::optional(upper ? range->second : range->first) : std::nullopt);
  return ends;
}

}  // namespace

const ReportSchema& AttributeInfo::schema() {
  static constexpr ReportRow rows[] = {
      reported<[](const AttributeInfo& r) { return printable(r.name); }>({.name = "name", .text = "Name"}),
      reported<&AttributeInfo::of>({.text = "Kind of element: point, triangle or cell"}),
      reported<[](const AttributeInfo& r) { return name_of(r.type); }>({.name = "type", .text = "Type of its numbers"}),
      reported<[](const AttributeInfo& r) { return r.ranges.size(); }>(
          {.name = "components", .text = "Numbers per element"}),
      reported<[](const AttributeInfo& r) { return ends_of(r, false); }>(
          {.name = "lower", .text = "Least number of each component"}),
      reported<[](const AttributeInfo& r) { return ends_of(r, true); }>(
          {.name = "upper", .text = "Largest number of each component"}),
      reported<&AttributeInfo::not_finite>({.text = "Numbers that are not finite, for arrays of volumes"})};
  return report_schema<rows>();
}

namespace {

const ReferenceSystem& system_of(const CloudInfo& info) {
  static const ReferenceSystem unknown;
  return info.reference ? *info.reference : unknown;
}

std::optional<ReportCounts> counted_classes(const CloudInfo& info) {
  if (!info.classes) return std::nullopt;
  ReportCounts counts;
  for (std::size_t c = 0; c < info.classes->size(); ++c)
    if (const std::size_t count = (*info.classes)[c]; count > 0)
      counts.emplace_back(std::to_string(c), static_cast<std::int64_t>(count));
  return counts;
}

}  // namespace

const ReportSchema& CloudInfo::schema() {
  static constexpr ReportRow rows[] = {
      reported<&CloudInfo::points>({.text = "Points or vertices"}),
      reported<&CloudInfo::duplicates>({.text = "Points that coincide with another"}),
      reported<[](const CloudInfo& r) { return r.box.lower; }>(
          {.name = "lower", .text = "Lower corner of the box", .unit = "length"}),
      reported<[](const CloudInfo& r) { return r.box.upper; }>(
          {.name = "upper", .text = "Upper corner of the box", .unit = "length"}),
      reported<&CloudInfo::spans>({.text = "Shape of the cloud, as text"}),
      reported<&CloudInfo::spacing>({.text = "Spacing of the points", .unit = "length"}),
      reported_inline<&CloudInfo::noise>(),
      reported<[](const CloudInfo& r) { return r.normals.words; }>({.name = "normals", .text = "Normals, as text"}),
      reported<&CloudInfo::normals>({.name = "orientation", .text = "Orientation of the normals"}),
      reported<&CloudInfo::orient_by>({.text = "Source of signs for new normals", .choices = kOrientByWords}),
      reported<&CloudInfo::colors>({.text = "Whether there are colours"}),
      reported<&CloudInfo::attributes>({.text = "Attributes"}),
      reported<&CloudInfo::scanners>({.text = "Scanners with known positions"}),
      reported<&CloudInfo::triangles>({.text = "Triangles of the file"}),
      reported<&CloudInfo::mesh>({.text = "Connectivity of the triangles, sewn along coincident borders"}),
      reported<[](const CloudInfo& r) { return counted_classes(r); }>(
          {.name = "classes", .text = "Points of each class, by its number"}),
      reported<[](const CloudInfo& r) { return value_if(system_of(r).code != 0, system_of(r).code); }>(
          {.name = "epsg", .text = "EPSG code of the reference system"}),
      reported<[](const CloudInfo& r) {
        return value_if(system_of(r).vertical_code != 0, system_of(r).vertical_code);
      }>({.name = "vertical_epsg", .text = "EPSG code of the heights"}),
      reported<[](const CloudInfo& r) { return value_if(system_of(r).metres > 0, system_of(r).metres); }>(
          {.name = "metres_per_unit", .text = "Length of the unit of the coordinates", .unit = "metres"}),
      reported<[](const CloudInfo& r) {
        return value_if(!system_of(r).vertical_unit.empty(), system_of(r).vertical_unit);
      }>({.name = "vertical_unit", .text = "Unit of the heights"}),
      reported<[](const CloudInfo& r) { return value_if(!system_of(r).wkt.empty(), system_of(r).wkt); }>(
          {.name = "wkt", .text = "Reference system as well-known text"})};
  return report_schema<rows>();
}

namespace {

/// Number of points in each class.
std::string classes_words(const CloudInfo& made) {
  std::string text;
  for (unsigned c = 0; made.classes && c < made.classes->size(); ++c) {
    if ((*made.classes)[c] == 0) continue;
    const std::string_view name = point_class_name(c);
    text += fmt::format("{}{}{}: {}", text.empty() ? "" : ", ", c, name.empty() ? "" : fmt::format(" {}", name),
                        grouped((*made.classes)[c]));
  }
  return text;
}

}  // namespace

std::string box_words(const Box3& box) {
  return fmt::format("from {} to {}", point_words(box.lower, 10), point_words(box.upper, 10));
}

std::string array_words(const AttributeInfo& a) {
  constexpr std::size_t kMostRanges = 9;
  const int digits = a.type == NumberType::f32 ? 6 : 10;  // times of surveys need the last digits
  std::string ranges;
  for (std::size_t c = 0; c < std::min(kMostRanges, a.ranges.size()); ++c) {
    const auto& range = a.ranges[c];
    ranges += c > 0 ? ", " : "";
    ranges += range ? fmt::format("{:.{}g} to {:.{}g}", range->first, digits, range->second, digits) : "no numbers";
  }
  if (a.ranges.size() > kMostRanges) ranges += ", …";
  if (a.not_finite.value_or(0) > 0) ranges += fmt::format("; {} not finite", counted(*a.not_finite, "number"));
  return fmt::format("{} ({}{} a {}): {}", printable(a.name, 80), name_of(a.type),
                     a.ranges.size() > 1 ? fmt::format(" × {}", a.ranges.size()) : "", a.of, ranges);
}

std::vector<std::string> summary_of(const CloudInfo& made) {
  std::vector<std::string> lines;
  const auto line = [&](const char* title, const std::string& text) { lines.push_back(titled(title, text, 12)); };
  line("points",
       fmt::format("{}{}", grouped(made.points),
                   made.duplicates > 0 ? fmt::format(", {} of them duplicates", grouped(made.duplicates)) : ""));
  line("box", fmt::format("{}, {}", size_words(made.size), box_words(made.box)));
  if (made.reference) line("system", system_words(*made.reference));
  line("spans", made.spans);
  line("spacing", length_words(made.spacing));
  line("noise", noise_words(made.noise, made.spacing));
  line("normals",
       fmt::format("{}{}", made.normals.words,
                   made.normals.oriented ? "" : fmt::format("; signs {}", orientation_words(made.orient_by))));
  if (made.colors || made.scanners > 0)
    line("also", fmt::format("{}{}{}", made.colors ? "colours" : "", made.colors && made.scanners > 0 ? ", " : "",
                             made.scanners > 0 ? counted(made.scanners, "scanner position") : ""));
  for (const AttributeInfo& a : made.attributes) line("attribute", array_words(a));
  if (const std::string classes = classes_words(made); !classes.empty()) line("classes", classes);
  if (made.mesh)
    line("faces", fmt::format("{}, {}", counted(made.mesh->triangles, "triangle"), topology_words(*made.mesh)));
  return lines;
}

std::vector<std::string> summary_of(const FunctionInfo& made) {
  std::vector<std::string> lines;
  const auto line = [&](const char* title, const std::string& text) { lines.push_back(titled(title, text, 12)); };
  line("fits", fmt::format("{} down to depth {}; of degree 0 to 4: {}", grouped(made.fits), made.depth,
                           fmt::join(made.fits_of_degree, ", ")));
  line("creases", counted(made.creased, "fit"));
  if (made.open_share > 0)
    line("open",
         fmt::format("{:.3g} % of the surface bounds no solid and ends with its samples", 100 * made.open_share));
  line("samples", fmt::format("{}{}", made.samples == 0 ? std::string("not kept") : grouped(made.samples),
                              made.colors ? ", with colours" : ""));
  line("cube", box_words(made.cube));
  line("spacing", length_words(made.spacing));
  line("deviation",
       fmt::format("{} (of the samples from the surface, root mean square)", length_words(made.deviation)));
  line("accuracy", fmt::format("{} (expected error of the surface)", length_words(made.accuracy)));
  for (const std::string& edit : made.history) line("edited", edit);
  return lines;
}

}  // namespace sansmesh::inline v1
