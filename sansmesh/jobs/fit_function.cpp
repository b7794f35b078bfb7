#include "sansmesh/jobs/fit_function.h"

#include <utility>

#include "sansmesh/points/orient_words.h"

namespace sansmesh::inline v1 {

FitFunctionResult fit_function(PointSet points, const FitFunctionOptions& options, Progress& progress) {
  options.validate();
  PreparedCloud cloud = prepare_cloud(std::move(points), options.cloud, progress);
  FitFunctionReport report{.estimated_normals = cloud.estimated_normals,
                           .oriented_by = cloud.oriented_by,
                           .alignment = cloud.alignment,
                           .function = {},
                           .paper = {}};
  SurfaceFunction function = fit_surface_function(std::move(cloud), options.fit, progress);
  report.function = info(function);
  report.paper = function.paper;
  FitFunctionResult result{std::move(function), std::move(report), {}};
  add_notes(result.notes, "preparation", result.function.warnings);
  return result;
}

namespace {

constexpr ReportRow kFitFunctionReportRows[] = {
    reported<&FitFunctionReport::estimated_normals>(
        {.name = "normals.estimated", .text = "Whether normals were estimated"}),
    reported<&FitFunctionReport::oriented_by>({.name = "normals.oriented_by",
                                               .text = "From what normals got their signs; nothing: from the input",
                                               .choices = kOrientByWords}),
    reported<[](const FitFunctionReport& r) { return told_if(!r.alignment.empty(), r.alignment); }>(
        {.name = "alignment", .text = "How scans were aligned, in words"}),
    reported<[](const FitFunctionReport& r) { return r.function.deviation; }>(
        {.name = "deviation", .text = "Standard deviation of the samples off the surface", .unit = "length"}),
    reported<[](const FitFunctionReport& r) { return r.function.accuracy; }>(
        {.name = "accuracy", .text = "Expected error of the surface", .unit = "length"}),
    reported<[](const FitFunctionReport& r) { return r.function.depth; }>(
        {.name = "depth", .text = "Deepest level of the tree"}),
    reported<[](const FitFunctionReport& r) { return r.function.fits; }>({.name = "fits", .text = "Local fits"}),
    reported<[](const FitFunctionReport& r) { return r.function.fits_of_degree; }>(
        {.name = "fits_of_degree", .text = "Local fits of degree 0 to 4"}),
    reported<[](const FitFunctionReport& r) { return r.function.creased; }>(
        {.name = "creased", .text = "Local fits with a crease"}),
    reported<&FitFunctionReport::paper>({.text = "How blocks came to be, of fits as the sources have them"})};

}  // namespace

const ReportSchema& FitFunctionReport::schema() {
  static constexpr ReportSchema schema{kFitFunctionReportRows};
  return schema;
}

}  // namespace sansmesh::inline v1
