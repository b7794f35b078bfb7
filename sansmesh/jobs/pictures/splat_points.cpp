#include "sansmesh/jobs/pictures/splat_points.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/data/world_points.h"
#include "sansmesh/error.h"
#include "sansmesh/image.h"
#include "sansmesh/model/sample_surface.h"
#include "sansmesh/surface/curvature.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kFewestSplats = 20000, kMostSplats = 300000;
constexpr float kMostStretch = 1.5f;
/// Angle between normals of neighbouring splats, in radians, at which splats are stretched fully.
constexpr float kFullyBent = 0.3f;

}  // namespace

SplatPoints spread_splats(const SurfaceModel& model, std::size_t count, const ColorField* colors, Progress& progress) {
  const std::size_t given = std::max(model.points().size(), model.balls().centers.size());
  if (count == 0) count = std::clamp(given, kFewestSplats, kMostSplats);
  SplatPoints splats;
  PointSet& points = splats.points;
  points = resample_surface(model, count, {}, progress);
  if (points.size() == 0) throw DataError("no point of the surface was found");
  move_from_input(points, model.frame());
  points.colors.clear();
  if (colors) {
    const std::vector<Vec3> x = world_points(points.origin, points.positions);
    std::vector<Vec3f> found(x.size());
    colors->evaluate(x, found);
    for (const Vec3f& c : found) points.colors.push_back(to_bytes(c));
  }
  progress.begin("curvature");
  // The points are on the surface, so they have no noise.
  const std::vector<FittedCurvatures> curvatures =
      estimate_curvatures(points, {.neighbours = 20, .noise = 0.0}, progress);
  const float spacing =
      static_cast<float>(model.frame().from_input(model.report().spacing)) *
      std::sqrt(static_cast<float>(std::max<std::size_t>(1, given)) / static_cast<float>(points.size()));
  splats.stretches.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const FittedCurvatures& c = curvatures[i];
    if (!c.defined) continue;
    const bool first = std::abs(c.k1) > std::abs(c.k2);
    const float more = std::abs(first ? c.k1 : c.k2), less = std::abs(first ? c.k2 : c.k1);
    const float most =
        less * kMostStretch * kMostStretch > more ? std::sqrt(more / std::max(less, 1e-20f)) : kMostStretch;
    splats.stretches[i] = {first ? c.direction2 : c.direction1,
                           1 + (most - 1) * std::min(1.0f, more * spacing / kFullyBent)};
  }
  progress.finish();
  return splats;
}

}  // namespace sansmesh::inline v1
