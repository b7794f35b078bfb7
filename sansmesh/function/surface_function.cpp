#include "sansmesh/function/surface_function.h"

#include <utility>

#include "sansmesh/core/error.h"
#include "sansmesh/partition/partition_fit.h"

namespace sansmesh {
namespace {

/// In the unit of a prepared cloud, which is about 1 large.
constexpr double kMostError = 10;

/// With lengths in own coordinates.
PartitionOptions partition_options(const FitOptions& options, const Placement& place) {
  PartitionOptions fit;
  fit.max_depth = options.max_depth;
  if (options.error) fit.error = place.from_input(*options.error);
  fit.support = options.support;
  fit.max_degree = options.max_degree;
  fit.sharp = options.sharp;
  fit.open = options.open;
  return fit;
}

}  // namespace

void FitOptions::validate() const { partition_options(*this, {}).validate(); }

SurfaceFunction fit_surface_function(PointSet points, const FitOptions& options, Progress& progress) {
  options.validate();
  // A function keeps none: before the cloud is copied about.
  points.attributes.clear();
  points.triangle_attributes.clear();
  return fit_surface_function(prepare_cloud(std::move(points), {}, progress), options, progress);
}

SurfaceFunction fit_surface_function(PreparedCloud cloud, const FitOptions& options, Progress& progress) {
  options.validate();
  cloud.points.attributes.clear();  // nor through the whole fit
  cloud.points.triangle_attributes.clear();
  const PartitionOptions fit = partition_options(options, cloud.place);
  if (fit.error && !(*fit.error <= kMostError)) throw ArgumentError("`error` is larger than the cloud");
  const bool of_faces = cloud.points.of_faces;
  auto samples = std::make_shared<PointSet>();
  PartitionOfUnity field = fit_partition_of_unity(std::move(cloud.points), fit, progress, samples.get());
  samples->of_faces = of_faces;
  return {std::move(field), cloud.place, std::move(samples), {}, std::move(cloud.warnings)};
}

}  // namespace sansmesh
