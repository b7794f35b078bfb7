#include "sansmesh/function/surface_function.h"

#include <fmt/core.h>

#include <cmath>
#include <string>
#include <utility>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/error.h"

namespace sansmesh {
namespace {

/// In the unit of a prepared cloud, which is about 1 large.
constexpr double kMostError = 10;

}  // namespace

void FitOptions::validate() const {
  const auto check = [](bool ok, const std::string& what) {
    if (!ok) throw ArgumentError(what);
  };
  check(!max_depth || (*max_depth >= kLeastDepth && *max_depth <= kMostDepth),
        fmt::format("`max_depth` must lie in {}..{}", kLeastDepth, kMostDepth));
  check(!error || (std::isfinite(*error) && *error > 0), "`error` must be a positive length");
  if (support) check_range("support", *support, 1.1, 2);
  check_range("max_degree", max_degree, 1, 4);
}

SurfaceFunction fit_surface_function(PointSet points, const FitOptions& options, Progress& progress) {
  options.validate();
  points.attributes.clear();  // a function keeps none; before the cloud is copied about
  points.triangle_attributes.clear();
  return fit_surface_function(prepare_cloud(std::move(points), {}, progress), options, progress);
}

SurfaceFunction fit_surface_function(PreparedCloud cloud, const FitOptions& options, Progress& progress) {
  options.validate();
  PartitionOptions fit;
  fit.max_depth = options.max_depth;
  if (options.error) fit.error = cloud.place.from_input(*options.error);
  if (fit.error && !(*fit.error <= kMostError)) throw ArgumentError("`error` is larger than the cloud");
  fit.support = options.support;
  fit.max_degree = options.max_degree;
  fit.sharp = options.sharp;
  auto samples = std::make_shared<PointSet>();
  PartitionOfUnity field = fit_partition_of_unity(std::move(cloud.points), fit, progress, samples.get());
  return {std::move(field), cloud.place, std::move(samples), {}, std::move(cloud.warnings)};
}

}  // namespace sansmesh
