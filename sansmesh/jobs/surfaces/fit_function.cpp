#include "sansmesh/functions.h"

#include <utility>
#include <vector>

#include "sansmesh/function/fitted_function.h"
#include "sansmesh/points/orientation/orient_words.h"
#include "sansmesh/points/prepare_cloud.h"

namespace sansmesh::inline v1 {

const OptionSchema& FitFunctionOptions::schema() {
  using O = FitFunctionOptions;
  static const OptionRow rows[] = {option_group<&O::cloud>(CloudPreparation::schema().rows),
                                   option_group<&O::fit>(FitOptions::schema().rows)};
  return option_schema<rows>();
}

FitFunctionResult fit_function(PointSet points, const FitFunctionOptions& options, Progress& progress) {
  options.validate();
  PreparedCloud cloud = prepare_cloud(std::move(points), options.cloud, progress, ClutterUse::leave_out);
  FitFunctionReport report{cloud.estimated_normals, cloud.oriented_by, cloud.alignment};
  FittedFunction function = fit_surface_function(std::move(cloud), options.fit, progress);
  std::vector<Note> notes = std::move(function.notes);
  return {SurfaceFunction(std::move(function)), std::move(report), std::move(notes)};
}

const ReportSchema& FitFunctionReport::schema() {
  static constexpr ReportRow rows[] = {
      reported<&FitFunctionReport::estimated_normals>(
          {.name = "normals.estimated", .text = "Whether normals were estimated"}),
      reported<&FitFunctionReport::oriented_by>({.name = "normals.oriented_by",
                                                 .text = "Source of the signs of normals; null: the input",
                                                 .choices = kOrientByWords}),
      reported<[](const FitFunctionReport& r) { return value_if(!r.alignment.empty(), r.alignment); }>(
          {.name = "alignment", .text = "Registration of scans, as text"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
