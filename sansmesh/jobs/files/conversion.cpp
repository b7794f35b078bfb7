#include "sansmesh/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/data/reference_system.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/jobs/files/cloud_or_mesh.h"

namespace sansmesh::inline v1 {
namespace {

/// Performs a step and returns its remark.
struct ApplyStep {
  CloudOrMesh& data;
  const std::string& unit;  ///< unit of the input
  Progress& progress;
  AboutStep about_now = {};

  std::string about(const AffineMap& map, const std::optional<Vec3>& point, bool center) const {
    const AboutStep own{point, center}, &used = point || center ? own : about_now;
    if (used.center) return move_all(data, map.about(data.bounds().center()));
    return move_all(data, used.fixed_point ? map.about(*used.fixed_point) : map);
  }

  std::string operator()(const AboutStep& s) {
    about_now = s;
    return {};
  }

  std::string operator()(const TransformStep& s) const { return move_all(data, s.inverse ? s.map.inverse() : s.map); }
  std::string operator()(const TranslateStep& s) const { return move_all(data, AffineMap::translation(s.by)); }
  std::string operator()(const CenterStep&) const {
    return move_all(data, AffineMap::translation(-data.bounds().center()));
  }
  std::string operator()(const RotateStep& s) const {
    return about(AffineMap::rotation(s.axis, s.degrees), s.about, s.about_center);
  }
  std::string operator()(const ScaleStep& s) const {
    return about(AffineMap::scaling(s.factors), s.about, s.about_center);
  }
  std::string operator()(const AxesStep& s) const { return move_all(data, axes_map(s.axes)); }
  std::string operator()(const UpStep& s) const {
    return move_all(data, axes_map(s.to == StepUp::z ? "x,-z,y" : "x,z,-y"));
  }
  std::string operator()(const UnitStep& s) const {
    const double factor = meters_of_unit(s.from.empty() ? unit : s.from) / meters_of_unit(s.to);
    return move_all(data, AffineMap::scaling({factor, factor, factor}));
  }
  std::string operator()(const CropStep& s) const { return crop_to_box(data, s.box, s.inside); }
  std::string operator()(const SpacingStep& s) const { return keep_apart(data, s.distance); }
  std::string operator()(const CountStep& s) const { return keep_count(data, s.count); }
  std::string operator()(const EveryStep& s) const { return keep_every(data, s.every); }
  std::string operator()(const ChooseStep& s) const { return choose_attributes(data, s.names, s.keep); }
  std::string operator()(const WeldStep& s) const { return weld_points(data, s.distance); }
  std::string operator()(const FlipStep& s) const { return flip_sides(data, s.faces, s.normals); }
  std::string operator()(const ClassifyGroundStep&) const { return find_ground_of(data, progress); }
};

/// "`box` leaves nothing …".
std::string in_backticks(std::string_view name) { return "`" + std::string(name) + "`"; }

ConvertStepReport apply_step(CloudOrMesh& data, const ConvertStep& step, ApplyStep& how) {
  ConvertStepReport done{.step = step_name(step), .remark = {}, .triangles = {}};
  const Box3 box = data.bounds();
  const std::string before = data.size_words();
  try {
    done.remark = std::visit(how, step);
  } catch (const DataError& error) {
    const std::string cause = error.what();
    const bool sentence = cause.starts_with("a ") || cause.starts_with("there ");
    throw DataError(in_backticks(done.step) + (sentence ? ": " : " ") + cause);
  }
  if (data.size() == 0 || (data.is_mesh && data.mesh.triangles.empty()))
    throw DataError(fmt::format("{} leaves nothing of {} between {} and {}", in_backticks(done.step), before,
                                point_words(box.lower, 10), point_words(box.upper, 10)));
  done.size = data.size();
  if (data.is_mesh) done.triangles = data.mesh.triangles.size();
  return done;
}

constexpr const char* kUnitsTogether =
    "`unit` and `to_unit` belong together: from which unit to which (without `unit`, that of the reference system)";

/// Unit of the lengths, if the reference system states one for all coordinates.
std::string stated_unit(const CloudOrMesh& data) {
  const auto& reference = data.is_mesh ? data.mesh.reference : data.points.reference;
  if (!reference || (!reference->vertical_unit.empty() && reference->vertical_unit != reference->unit)) return {};
  static constexpr std::pair<std::string_view, const char*> names[] = {
      {"metre", "m"}, {"foot", "ft"}, {"US survey foot", "us-ft"}};
  for (const auto& [name, unit] : names)
    if (reference->unit == name) return unit;
  return {};
}

}  // namespace

const OptionSchema& ConvertOptions::schema() {
  using O = ConvertOptions;
  static const OptionRow rows[] = {
      option<&O::vertices_only>({.text = "Only the vertices of a mesh", .old_name = "points"}),
      option<&O::unit>({.text = "Unit of the input's lengths, for `to_unit`: um, mm, cm, m, km, in, ft or us-ft",
                        .unit = "unit",
                        .from_data = "that of the reference system"}),
      option_steps<&O::steps>(convert_step_rows())};
  return option_schema<rows>();
}

void ConvertOptions::validate() const {
  if (!unit.empty()) meters_of_unit(unit);
  std::size_t units = 0;
  bool about_waits = false;
  for (const ConvertStep& step : steps) {
    validate_step(step);
    if (const auto* const to = std::get_if<UnitStep>(&step)) units += to->from.empty();
    if (std::holds_alternative<AboutStep>(step)) about_waits = true;
    if (std::holds_alternative<RotateStep>(step) || std::holds_alternative<ScaleStep>(step)) about_waits = false;
  }
  if (units > 1) throw ArgumentError("`to_unit` is given twice");
  if (units == 0 && !unit.empty()) throw ArgumentError(kUnitsTogether);
  if (about_waits) throw ArgumentError("`about` is for `rotate` and `scale` after it, and none follows");
}

void check_converted(const std::string& file, bool as_points) {
  const bool mesh = is_written(file, "mesh"), points = is_written(file, "points");
  if (!mesh && !points && is_read(file))
    throw FileError(file, "this format is read, not written; use .ply, .vtp, .las or .csv");
  check_writable(file, mesh && !(as_points && points) ? "mesh" : "points");
}

std::vector<Note> fit_to_format(CloudOrMesh& data, const std::string& file) {
  std::vector<Note> notes;
  if (data.is_mesh && !is_written(file, "mesh")) {
    notes.push_back(
        {.code = "no_faces",
         .text = fmt::format("holds points only: {} left out", counted(data.mesh.triangles.size(), "triangle")),
         .of = file});
    data.make_points();
  }
  if (!data.is_mesh && !is_written(file, "points"))
    throw FileError(file,
                    "is of a format for meshes, and there are only points; a reconstruction makes a mesh of them, "
                    ".ply .obj .xyz .csv .pcd .vtp .las hold points");
  return notes;
}

std::vector<std::string> left_out(const std::string& file, const CloudOrMesh& data) {
  return data.is_mesh ? left_out(file, data.mesh) : left_out(file, data.points);
}

void write_converted(const std::string& file, const CloudOrMesh& data, bool ascii) {
  if (data.is_mesh)
    write_mesh(file, data.mesh, {.ascii = ascii});
  else
    write_points(file, data.points, {.ascii = ascii});
}

std::vector<std::string> summary_of(const ConvertReport& report) {
  std::vector<std::string> lines;
  for (const ConvertStepReport& done : report.steps)
    if (!done.remark.empty()) lines.push_back(in_backticks(done.step) + ": " + done.remark);
  return lines;
}

ConvertResult convert(PointSet read, const ConvertOptions& options, Progress& progress) {
  options.validate();
  ConvertResult result{CloudOrMesh(std::move(read)), {}, {}};
  CloudOrMesh& data = result.data;
  result.report.size_words = data.size_words();
  result.report.size = data.size(), result.report.triangles = data.mesh.triangles.size();
  if (options.vertices_only) data.make_points();
  const std::string unit = options.unit.empty() ? stated_unit(data) : options.unit;
  for (const ConvertStep& step : options.steps)
    if (const auto* const to = std::get_if<UnitStep>(&step); to && to->from.empty() && unit.empty())
      throw ArgumentError(kUnitsTogether);
  ApplyStep how{data, unit, progress};
  for (const ConvertStep& step : options.steps) {
    if (const auto* const about = std::get_if<AboutStep>(&step)) {
      how(*about);
      continue;
    }
    progress.begin(std::string(step_name(step)));
    result.report.steps.push_back(apply_step(data, step, how));
  }
  if (data.nonmanifold_edges_of_weld > 0)
    result.notes.push_back(
        {.code = "nonmanifold_weld",
         .text = fmt::format("`weld` made {} with three or more triangles: the mesh is not manifold there",
                             counted(data.nonmanifold_edges_of_weld, "edge"))});
  if (data.former_reference)
    result.notes.push_back({.code = "moved_coordinates",
                            .text = "moved coordinates are no longer in the reference system of the input (" +
                                    system_words(*data.former_reference) + "), which was left out"});
  if (!data.untransformed.empty())
    result.notes.push_back({.code = "unturned",
                            .text = fmt::format("attributes of three numbers are not rotated: {}",
                                                printable(fmt::format("{}", fmt::join(data.untransformed, ", "))))});
  return result;
}

const ReportSchema& ConvertStepReport::schema() {
  static constexpr ReportRow rows[] = {
      reported<[](const ConvertStepReport& r) { return std::string(r.step); }>({.name = "step", .text = "Step"}),
      reported<[](const ConvertStepReport& r) { return value_if(!r.triangles, r.size); }>(
          {.name = "points", .text = "Points after it"}),
      reported<[](const ConvertStepReport& r) { return value_if(r.triangles.has_value(), r.size); }>(
          {.name = "vertices", .text = "Vertices after it"}),
      reported<&ConvertStepReport::triangles>({.text = "Triangles after it"}),
      reported<[](const ConvertStepReport& r) { return value_if(!r.remark.empty(), r.remark); }>(
          {.name = "remark", .text = "Effect on the data, as text"})};
  return report_schema<rows>();
}

const ReportSchema& ConvertReport::schema() {
  static constexpr ReportRow rows[] = {
      reported<[](const ConvertReport& r) { return value_if(r.triangles == 0, r.size); }>(
          {.name = "input.points", .text = "Points of the input"}),
      reported<[](const ConvertReport& r) { return value_if(r.triangles > 0, r.size); }>(
          {.name = "input.vertices", .text = "Vertices of the input"}),
      reported<[](const ConvertReport& r) { return value_if(r.triangles > 0, r.triangles); }>(
          {.name = "input.triangles", .text = "Triangles of the input"}),
      reported<&ConvertReport::steps>({.text = "Steps in order"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
