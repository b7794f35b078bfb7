#include "sansmesh/jobs/fit_function.h"

#include <utility>

namespace sansmesh::inline v1 {

FitFunctionResult fit_function(PointSet points, const FitFunctionOptions& options, Progress& progress) {
  options.validate();
  PreparedCloud cloud = prepare_cloud(std::move(points), options.cloud, progress);
  FitFunctionReport report{cloud.estimated_normals, cloud.oriented_by, cloud.alignment};
  SurfaceFunction function = fit_surface_function(std::move(cloud), options.fit, progress);
  FitFunctionResult result{std::move(function), std::move(report), {}};
  add_notes(result.notes, "preparation", result.function.warnings);
  return result;
}

}  // namespace sansmesh::inline v1
