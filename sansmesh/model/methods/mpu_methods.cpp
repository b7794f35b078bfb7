// Multi-level partition of unity implicits as a surface (docs/methods/mpu.md).
#include <algorithm>
#include <memory>

#include "sansmesh/model/surface_method.h"
#include "sansmesh/surface/mpu/mpu_surface.h"
#include "sansmesh/surface_options.h"

namespace sansmesh::inline v1 {
namespace {

/// Ball radius over block edge for cells that close holes, where the local spacing is unknown.
constexpr float kGapBlocks = 2;

/// Balls around the samples, as for the other surfaces, and balls of cells with too few samples, which close holes.
SurfaceParts make_mpu(PreparedCloud& cloud, const SurfaceOptions& options, Progress& progress) {
  if (!options.smooth) sharpen_estimated_normals(cloud, progress);
  const SurfaceSamples samples = prepare_samples(cloud.points, progress, cloud.noise);
  PointSet points;
  points.positions = samples.positions, points.normals = samples.normals;
  const auto surface = std::make_shared<const MpuSurface>(make_mpu_surface(
      points,
      {.error = options.error, .max_depth = options.depth, .sharp = !options.smooth, .spacing = samples.median_spacing},
      progress));
  SurfaceParts parts;
  parts.field = surface;
  BallUnion& balls = parts.support;
  balls.centers = samples.positions, parts.spacings = samples.spacing;
  const auto reach = static_cast<float>(default_reach(samples));
  for (const float s : samples.spacing) balls.radii.push_back(reach * s);
  const BallUnion gaps = surface->gap_balls({samples.tree, balls.radii});
  for (std::size_t i = 0; i < gaps.centers.size(); ++i) {
    const auto near = samples.tree.nearest(gaps.centers[i]);
    if (!near) continue;
    balls.centers.push_back(gaps.centers[i]), balls.radii.push_back(gaps.radii[i]);
    parts.spacings.push_back(std::max(gaps.radii[i] / kGapBlocks, samples.spacing[near->index]));
  }
  parts.traits.closes_holes = true;
  parts.traits.creases = surface->report().edges + surface->report().corners > 0;
  parts.spacing = samples.median_spacing, parts.noise = samples.noise;
  return parts;
}

constexpr std::string_view kUses[] = {"error", "depth", "smooth"};

constexpr SurfaceMethod kMpu[] = {
    {.name = "mpu",
     .summary = "quadrics on an octree, with edges and corners, blended (MPU): closed; for clean parts",
     .page = "mpu.md",
     .make = make_mpu,
     .uses = kUses,
     .instead = "its balls follow the data, and its edges are those of its pieces"}};

}  // namespace

std::span<const SurfaceMethod> mpu_methods() { return kMpu; }

}  // namespace sansmesh::inline v1
