#include "sansmesh/attribute_table.h"
#include "sansmesh/model/sample_surface.h"
#include "sansmesh/model/surface_method.h"
#include "sansmesh/model/surface_model.h"
#include "sansmesh/option.h"
#include "sansmesh/points.h"
#include "sansmesh/points/prepare_cloud.h"
#include "sansmesh/surface/lop.h"

#include <fmt/core.h>

#include <string_view>
#include <utility>

#include "sansmesh/data/reference_system.h"
#include "sansmesh/error.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/schema/registry_words.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::string_view kSuited = "auto", kLop = "lop";
constexpr double kMostPoints = 2e9;

const std::vector<std::string_view>& project_methods() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all{kSuited, kLop};
    const auto& surfaces = registry_names<SurfaceMethod>();
    all.insert(all.end(), surfaces.begin(), surfaces.end());
    return all;
  }();
  return names;
}

/// Empty: the recommended surface. Options that only some surfaces use imply `curvature`, which uses them.
std::optional<SurfaceOptions> surface_of(const ProjectOptions& o) {
  SurfaceOptions surface = o.surface;
  if (o.method != kSuited)
    surface.method = o.method;
  else if (!options_set(surface).empty())
    surface.method = "curvature";
  else
    return std::nullopt;
  return surface;
}

void check_lop(const ProjectOptions& o, bool onto) {
  const auto check = [](bool ok, std::string_view option, const char* why) {
    if (!ok) throw ArgumentError(fmt::format("`{}` does not apply to `method = lop`: {}", option, why));
  };
  const char* const what = "it uses the input points, without a surface";
  check(!onto, "onto", what);
  if (const auto set = options_set(o.surface); !set.empty()) check(false, set.front(), what);
  check(!o.cloud.remove_outliers.value_or(false), "remove_outliers", "stray samples hardly affect it");
  if (const auto set = options_set(o.steps); !set.empty()) check(false, set.front(), what);
}

PointSet on_surface(ProjectInput& input, const ProjectOptions& o, ProjectResult& result, Progress& progress) {
  const std::string& of = input.onto ? input.onto_name : input.name;
  return with_name(of, [&] {
    PreparedCloud prepared = prepare_cloud(input.onto ? std::move(*input.onto) : input.points, o.cloud, progress);
    const auto surface = surface_of(o);
    const SurfaceModel model = surface ? make_surface_model(std::move(prepared), *surface, progress)
                                       : make_recommended_surface(std::move(prepared), progress);
    result.report.method = model.report().method;
    add_notes(result.notes, model.notes(), of);
    SurfaceProjection& moved = result.report.moved;
    return o.point_count ? resample_surface(model, *o.point_count, o.steps, progress, &moved)
                         : project_points(input.points, model, o.steps, progress, &moved);
  });
}

PointSet consolidated(const ProjectInput& input, const ProjectOptions& o, ProjectReport& report, Progress& progress) {
  LopOptions lop = o.lop;
  lop.points = o.point_count;
  report.method = kLop;
  PointSet points = with_name(input.name, [&] { return consolidate(input.points, lop, progress); });
  report.moved.projected = points.size();
  return points;
}

}  // namespace

const OptionSchema& ProjectOptions::schema() {
  using O = ProjectOptions;
  static const std::string methods =
      "auto (recommended for the samples), lop (consolidation of the input) or a surface: " +
      SurfaceMethod::registry().names();
  static const OptionRow rows[] = {
      option<&O::method, ListedWords<project_methods>>({.text = methods, .unit = "name", .choices = project_methods()}),
      option<&O::point_count>(
          {.text = "Spread about this many new points over the surface instead of moving those given",
           .unit = "count",
           .range = {1, kMostPoints},
           .old_name = "points"}),
      option_group<&O::steps>(ProjectToSurface::schema().rows), option_group<&O::lop>(LopOptions::schema().rows)};
  return option_schema<rows>();
}

void ProjectOptions::validate() const {
  validate_options(*this);
  if (method == kLop) return check_lop(*this, false);
  if (const auto set = options_set(lop); !set.empty())
    throw ArgumentError(method == kSuited
                            ? fmt::format("`{}` needs `method = lop`", set.front())
                            : fmt::format("`{}` does not apply to `method = {}`: it needs lop", set.front(), method));
  if (const auto chosen = surface_of(*this)) chosen->validate();
}

ProjectResult project(ProjectInput input, const ProjectOptions& options, Progress& progress) {
  options.validate();
  ProjectResult result;
  if (options.method == kLop) {
    check_lop(options, input.onto.has_value());
    result.points = consolidated(input, options, result.report, progress);
    return result;
  }
  const std::string onto = input.onto ? input.onto_name : input.name;
  if (input.onto)
    require_same_system(input.points.reference.get(), input.name, input.onto->reference.get(), input.onto_name);
  result.points = on_surface(input, options, result, progress);
  if (result.points.size() == 0)
    throw DataError(fmt::format("{}: no point is near enough to the surface of {}", input.name, onto));
  return result;
}

const ReportSchema& ProjectReport::schema() {
  static constexpr ReportRow rows[] = {reported<&ProjectReport::method>({.text = "Name of the method"}),
                                       reported_inline<&ProjectReport::moved>()};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
