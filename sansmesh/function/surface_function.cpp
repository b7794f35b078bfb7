#include "sansmesh/function/surface_function.h"

#include <fmt/core.h>

#include <cmath>
#include <string>
#include <utility>

#include "sansmesh/core/error.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh {
namespace {

/// In the unit of a prepared cloud, which is about 1 large.
constexpr double kMostError = 10;

/// The arrays of a prepared cloud that a function keeps, in another order.
PointSet reordered(const PointSet& points, const std::vector<std::uint32_t>& order) {
  PointSet result;
  result.origin = points.origin;
  const auto take = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    to.resize(order.size());
    parallel_for(0, order.size(), 16384, [&](std::size_t i) { to[i] = from[order[i]]; });
  };
  take(points.positions, result.positions);
  take(points.normals, result.normals);
  take(points.colors, result.colors);
  return result;
}

}  // namespace

void FitOptions::validate() const {
  const auto check = [](bool ok, const std::string& what) {
    if (!ok) throw ArgumentError(what);
  };
  check(!max_depth || (*max_depth >= kLeastDepth && *max_depth <= kMostDepth),
        fmt::format("max depth must lie in {}..{}", kLeastDepth, kMostDepth));
  check(!error || (std::isfinite(*error) && *error > 0), "error must be a positive length");
  check(!support || (*support >= 1.1 && *support <= 2), "support must lie in 1.1..2");
  check(max_degree >= 1 && max_degree <= 4, "degree must lie in 1..4");
}

SurfaceFunction fit_surface_function(PointSet points, const FitOptions& options, Progress& progress) {
  options.validate();
  points.attributes.clear();  // a function keeps none; before the cloud is copied about
  points.triangle_attributes.clear();
  PreparedCloud cloud =
      prepare_cloud(std::move(points), {options.faces, options.normals, options.remove_outliers}, progress);
  PartitionOptions fit;
  fit.max_depth = options.max_depth;
  if (options.error) fit.error = *options.error / cloud.unit;
  if (fit.error && !(*fit.error <= kMostError)) throw ArgumentError("error is larger than the cloud");
  fit.support = options.support;
  fit.max_degree = options.max_degree;
  fit.sharp = options.sharp;
  std::vector<std::uint32_t> order;
  PartitionOfUnity field = fit_partition_of_unity(cloud.points, fit, progress, &order);
  auto samples = std::make_shared<const PointSet>(reordered(cloud.points, order));
  return {std::move(field), cloud.origin, cloud.unit, std::move(samples), {}, std::move(cloud.warnings)};
}

}  // namespace sansmesh
