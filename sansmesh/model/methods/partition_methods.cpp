#include "sansmesh/model/methods/partition_methods.h"

#include <cmath>
#include <memory>
#include <utility>

#include "sansmesh/partition/fit/partition_fit.h"

namespace sansmesh::inline v1 {
namespace {

/// The surface crosses a support if its distance from the centre is at most this many radii.
constexpr double kNearCenter = 1.2;

/// Supports that the surface crosses.
BallUnion support_balls(const PartitionOfUnity& partition) {
  BallUnion balls;
  std::vector<Vec3> centers;
  for (const LocalFunction& f : partition.functions()) centers.emplace_back(f.center);
  std::vector<double> values(centers.size());
  partition.evaluate(centers, values);
  for (std::size_t i = 0; i < centers.size(); ++i) {
    const LocalFunction& f = partition.functions()[i];
    if (std::abs(values[i]) > kNearCenter * static_cast<double>(f.radius)) continue;
    balls.centers.push_back(f.center);
    balls.radii.push_back(f.radius);
  }
  return balls;
}

SurfaceParts make_partition(PreparedCloud& cloud, const SurfaceOptions&, Progress& progress) {
  return partition_parts(fit_partition_of_unity(cloud.points, {}, progress));
}

constexpr SurfaceMethod kPartition[] = {
    {.name = kPartitionSurface,
     .summary = "local polynomials, blended (adaptive partition of unity): closed, with creases",
     .page = "partition-of-unity.md",
     .make = make_partition,
     .instead = "its supports and its creases follow the data"}};

}  // namespace

SurfaceParts partition_parts(PartitionOfUnity partition) {
  const auto field = std::make_shared<const PartitionOfUnity>(std::move(partition));
  SurfaceParts parts;
  parts.field = field;
  parts.support = support_balls(*field);
  parts.seeds = [field] { return field->seeds(); };
  parts.traits.closes_holes = true;
  parts.spacing = field->report().spacing, parts.noise = field->report().noise;
  return parts;
}

std::span<const SurfaceMethod> partition_methods() { return kPartition; }

}  // namespace sansmesh::inline v1
