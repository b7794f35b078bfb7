#include "sansmesh/function/fitted_function.h"

#include <fmt/core.h>

#include <utility>

#include "sansmesh/error.h"
#include "sansmesh/partition/fit/partition_fit.h"

namespace sansmesh::inline v1 {
namespace {

/// In the unit of a prepared cloud, which is about 1 large.
constexpr double kMostError = 10;

/// Converts lengths to local coordinates.
PartitionOptions partition_options(const FitOptions& options, const LocalFrame& frame) {
  PartitionOptions fit;
  fit.max_depth = options.depth;
  if (options.error) fit.error = frame.from_input(*options.error);
  fit.support = options.support;
  fit.max_degree = options.degree;
  fit.sharp = options.sharp;
  fit.open = options.open;
  return fit;
}

PaperOptions paper_options(const FitOptions& options) {
  PaperOptions fit;
  if (options.threshold) fit.threshold = *options.threshold;
  if (options.depth) fit.max_depth = *options.depth;
  if (options.support) fit.support = *options.support;
  if (options.coverage) fit.coverage = *options.coverage;
  fit.max_degree = options.degree;
  return fit;
}

}  // namespace

FittedFunction fit_surface_function(PointSet points, const FitOptions& options, Progress& progress) {
  options.validate();
  // A function keeps no attributes: they are dropped before the cloud is copied.
  points.attributes.clear();
  points.triangle_attributes.clear();
  return fit_surface_function(prepare_cloud(std::move(points), {}, progress), options, progress);
}

FittedFunction fit_surface_function(PreparedCloud cloud, const FitOptions& options, Progress& progress) {
  options.validate();
  cloud.points.attributes.clear();  // also drop them for the fit
  cloud.points.triangle_attributes.clear();
  if (options.is_paper()) {
    const bool faces = cloud.points.of_faces;
    auto sorted = std::make_shared<PointSet>();
    PaperReport report;
    PartitionOfUnity paper =
        fit_paper_partition(std::move(cloud.points), paper_options(options), progress, sorted.get(), &report);
    sorted->of_faces = faces;
    return {std::move(paper), cloud.frame, std::move(sorted), {}, std::move(cloud.notes), report};
  }
  PartitionOptions fit = partition_options(options, cloud.frame);
  if (!fit.open && cloud.closed_faces && cloud.points.of_faces) fit.open = false;
  if (fit.error && !(*fit.error <= kMostError)) throw ArgumentError("`error` is larger than the cloud");
  const bool of_faces = cloud.points.of_faces;
  auto samples = std::make_shared<PointSet>();
  PartitionOfUnity field = fit_partition_of_unity(std::move(cloud.points), fit, progress, samples.get());
  samples->of_faces = of_faces;
  return {std::move(field), cloud.frame, std::move(samples), {}, std::move(cloud.notes), {}};
}

}  // namespace sansmesh::inline v1
