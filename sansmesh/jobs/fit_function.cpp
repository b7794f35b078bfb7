#include "sansmesh/functions.h"

#include <utility>
#include <vector>

#include "sansmesh/function/fitted_function.h"
#include "sansmesh/points/orient_words.h"
#include "sansmesh/points/prepare_cloud.h"

namespace sansmesh::inline v1 {

const OptionSchema& FitFunctionOptions::schema() {
  using O = FitFunctionOptions;
  static const OptionRow rows[] = {option_group<&O::cloud>(CloudPreparation::schema().rows),
                                   option_group<&O::fit>(FitOptions::schema().rows)};
  static const OptionSchema schema{rows};
  return schema;
}

FitFunctionResult fit_function(PointSet points, const FitFunctionOptions& options, Progress& progress) {
  options.validate();
  PreparedCloud cloud = prepare_cloud(std::move(points), options.cloud, progress);
  FitFunctionReport report{cloud.estimated_normals, cloud.oriented_by, cloud.alignment};
  FittedFunction function = fit_surface_function(std::move(cloud), options.fit, progress);
  std::vector<Note> notes;
  add_notes(notes, "preparation", function.warnings);
  return {SurfaceFunction(std::move(function)), std::move(report), std::move(notes)};
}

const ReportSchema& FitFunctionReport::schema() {
  static constexpr ReportRow rows[] = {
      reported<&FitFunctionReport::estimated_normals>(
          {.name = "normals.estimated", .text = "Whether normals were estimated"}),
      reported<&FitFunctionReport::oriented_by>({.name = "normals.oriented_by",
                                                 .text = "From what normals got their signs; nothing: from the input",
                                                 .choices = kOrientByWords}),
      reported<[](const FitFunctionReport& r) { return told_if(!r.alignment.empty(), r.alignment); }>(
          {.name = "alignment", .text = "How scans were aligned, in words"})};
  static constexpr ReportSchema schema{rows};
  return schema;
}

}  // namespace sansmesh::inline v1
