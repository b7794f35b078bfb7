#include "sansmesh/render/splat/splat_scene.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <utility>

#include "sansmesh/core/index_in.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/image.h"
#include "sansmesh/mesh/vertex_corners.h"
#include "sansmesh/points/shape/principal_axes.h"
#include "sansmesh/render/scene/lighting.h"

namespace sansmesh::inline v1 {
namespace {

constexpr float kRadius = 0.75f;  // radius of a disc, relative to h
constexpr float kGamma = 0.5f;
constexpr std::int32_t kMostFronts = 100;
constexpr float kLift = 0.5f;  // relative to h: shadow rays start above the neighbours' discs
constexpr float kSteepestSplat = 0.1f;

std::vector<float> radii(const Splats& splats) {
  std::vector<float> r;
  r.reserve(splats.spacings.size());
  for (const float h : splats.spacings) r.push_back(kRadius * h);
  return r;
}

}  // namespace

Splats splats_at_vertices(const TriangleMesh& mesh, std::span<const Vec3f> vectors,
                          std::span<const std::int32_t> fronts, const RenderOptions& options,
                          const PictureFrame& frame) {
  const std::size_t n = mesh.vertices.size();
  const VertexCorners around(mesh.triangles, n);
  std::vector<Vec3f> positions(n), normals(n);
  std::vector<float> spacings(n), slopes(n);  // distances of neighbours and slopes of front numbers
  for (std::size_t v = 0; v < n; ++v) positions[v] = frame.to_picture(mesh.origin + Vec3(mesh.vertices[v]));
  parallel_for(0, n, 1024, [&](std::size_t v) {
    float farthest = 0;
    Vec3f side;
    const std::span<const std::uint32_t> corners = around[v];
    for (const std::uint32_t c : corners) {
      const Triangle& t = mesh.triangles[c / 3];
      side += cross(positions[t[1]] - positions[t[0]], positions[t[2]] - positions[t[0]]);
      for (const std::uint32_t o : t) farthest = std::max(farthest, norm(positions[o] - positions[v]));
    }
    if (!(farthest > 0) || !is_finite(side)) return;
    Symmetric3 covariance;
    Vec3 sum;
    double weights = 1;
    const auto each = [&](const auto& use) {
      for (const std::uint32_t c : corners)
        for (const std::uint32_t o : mesh.triangles[c / 3]) {
          if (o == v) continue;
          const Vec3 d(positions[o] - positions[v]);
          use(d, std::exp(-squared_norm(d) / (static_cast<double>(farthest) * static_cast<double>(farthest))));
        }
    };
    each([&](const Vec3& d, double w) { sum += d * w, weights += w; });
    const Vec3 mean = sum / weights;
    covariance.add(mean);
    each([&](const Vec3& d, double w) { covariance.add(d - mean, w); });
    Vec3f normal(smallest_axis(covariance));
    if (dot(normal, side) < 0) normal = -normal;
    normals[v] = normal;
    spacings[v] = squared_norm(normal) > 0 ? farthest : 0;
    // The flow may turn front lines nearly parallel to itself: the slope of the front numbers gives the number of
    // fronts across a disc.
    Vec3f a, b;
    tangent_frame(normal, a, b);
    double aa = 0, ab = 0, bb = 0, af = 0, bf = 0;
    for (const std::uint32_t c : corners)
      for (const std::uint32_t o : mesh.triangles[c / 3]) {
        const double x = dot(positions[o] - positions[v], a), y = dot(positions[o] - positions[v], b),
                     f = fronts[o] - fronts[v];
        aa += x * x, ab += x * y, bb += y * y, af += x * f, bf += y * f;
      }
    const double det = aa * bb - ab * ab;
    slopes[v] = det > 1e-12 * (aa + bb) * (aa + bb)
                    ? static_cast<float>(std::hypot(bb * af - ab * bf, aa * bf - ab * af) / det)
                    : 0;
  });
  Splats splats;
  const bool colored = options.look.use_colors && mesh.colors.size() == n;
  for (std::size_t v = 0; v < n; ++v) {
    if (!(spacings[v] > 0)) continue;
    splats.centers.push_back(positions[v]);
    splats.normals.push_back(normals[v]);
    splats.spacings.push_back(spacings[v]);
    splats.fronts.push_back(fronts[v]);
    splats.reaches.push_back(1 + index_in<std::int32_t>(2 * kRadius * spacings[v] * slopes[v], 0, kMostFronts));
    if (!vectors.empty()) splats.vectors.push_back(vectors[v]);
    Vec3f color = options.look.surface_color;
    if (colored) color = {from_byte(mesh.colors[v][0]), from_byte(mesh.colors[v][1]), from_byte(mesh.colors[v][2])};
    splats.colors.push_back(linear_color(color));
  }
  return splats;
}

SplatScene::SplatScene(Splats splats, float opacity)
    : splats_(std::move(splats)),
      opacity_(opacity),
      rays_(RayScene::discs(splats_.centers, splats_.normals, radii(splats_))) {}

/// Cosine to the normal of a disc.
float SplatScene::steepness(std::uint32_t splat, const Vec3f& direction) const {
  return std::max(kSteepestSplat, std::abs(dot(splats_.normals[splat], direction)));
}

/// Distance behind a hit up to which hits belong to the same sheet.
float SplatScene::depth(std::uint32_t splat, const Vec3f& direction) const {
  return 2 * kGamma * splats_.spacings[splat] / steepness(splat, direction);
}

/// Moves the hits of the foremost sheet from `hits` (by distance) to `sheet`.
void SplatScene::take_first(const Vec3f& direction, std::vector<RayCrossing>& hits,
                            std::vector<RayCrossing>& sheet) const {
  sheet.clear();
  const RayCrossing front = hits.front();
  const float limit = front.distance + depth(front.primitive, direction);
  std::size_t kept = 0;
  for (const RayCrossing& hit : hits) {
    const std::int32_t reach = std::max(splats_.reaches[hit.primitive], splats_.reaches[front.primitive]);
    const bool same =
        hit.distance <= limit && std::abs(splats_.fronts[hit.primitive] - splats_.fronts[front.primitive]) <= reach;
    if (same)
      sheet.push_back(hit);
    else
      hits[kept++] = hit;
  }
  hits.resize(kept);
}

SurfacePoint SplatScene::blend(const Vec3f& eye, const Vec3f& direction, std::span<const RayCrossing> hits) const {
  const float begin = hits[0].distance, h = splats_.spacings[hits[0].primitive],
              across = steepness(hits[0].primitive, direction) / (kGamma * h);
  const Vec3f& leading = splats_.normals[hits[0].primitive];
  SurfacePoint point;
  float weights = 0, distance = 0;
  for (const RayCrossing& hit : hits) {
    const std::size_t i = hit.primitive;
    const float r2 = squared_norm(eye + hit.distance * direction - splats_.centers[i]);
    const float s = (hit.distance - begin) * across, own = splats_.spacings[i];
    const float w = std::exp(-r2 / (own * own) - s * s);
    weights += w;
    distance += w * hit.distance;
    point.normal += splats_.normals[i] * (dot(splats_.normals[i], leading) < 0 ? -w : w);
    point.color += w * splats_.colors[i];
    if (!splats_.vectors.empty()) point.vector += w * splats_.vectors[i];
  }
  point.color *= 1 / weights;
  point.vector *= 1 / weights;
  point.normal = normalized(point.normal);
  if (dot(point.normal, direction) > 0) point.normal = -point.normal;
  point.distance = distance / weights;
  point.position = eye + point.distance * direction + point.normal * (kLift * h);
  if (opacity_ < 1) point.opacity = sheet_opacity(opacity_, dot(point.normal, direction));
  return point;
}

void SplatScene::closest(const EyeRays& rays, std::span<std::optional<SurfacePoint>> points) const {
  std::vector<std::optional<RayHit>> hits(rays.size());
  rays_.closest(rays.origins, rays.directions, rays.near, rays.far, hits);
  std::vector<RayCrossing> all, sheet;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    points[i].reset();
    if (!hits[i]) continue;
    const Vec3f &eye = rays.origin(i), &direction = rays.directions[i];
    rays_.crossings(eye, direction, hits[i]->distance + depth(hits[i]->primitive, direction), all);
    if (!rays.near.empty()) std::erase_if(all, [&](const RayCrossing& hit) { return hit.distance < rays.near[i]; });
    if (all.empty()) all.push_back({hits[i]->distance, hits[i]->primitive, true});
    take_first(direction, all, sheet);
    points[i] = blend(eye, direction, sheet);
  }
}

void SplatScene::layers(const EyeRays& rays, std::vector<std::size_t>& first, std::vector<SurfacePoint>& points) const {
  if (!(opacity_ < 1)) return PictureScene::layers(rays, first, points);
  first.assign(1, 0);
  points.clear();
  std::vector<RayCrossing> all, sheet;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Vec3f &eye = rays.origin(i), &direction = rays.directions[i];
    rays_.crossings(eye, direction, rays.far.empty() ? std::numeric_limits<float>::infinity() : rays.far[i], all);
    if (!rays.near.empty()) std::erase_if(all, [&](const RayCrossing& hit) { return hit.distance < rays.near[i]; });
    float left = 1;
    for (int n = 0; n < kMostSheets && !all.empty() && left >= kLeastThrough; ++n) {
      take_first(direction, all, sheet);
      points.push_back(blend(eye, direction, sheet));
      left *= 1 - points.back().opacity;
    }
    first.push_back(points.size());
  }
}

void SplatScene::blocked(std::span<const ShadowRay> rays, std::span<std::uint8_t> answers) const {
  for (std::size_t i = 0; i < rays.size(); ++i)
    answers[i] = rays_.blocked(rays[i].origin, rays[i].direction, rays[i].length, rays[i].near);
}

}  // namespace sansmesh::inline v1
