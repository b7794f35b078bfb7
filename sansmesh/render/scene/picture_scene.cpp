#include "sansmesh/render/scene/picture_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "sansmesh/error.h"
namespace sansmesh::inline v1 {

float sheet_opacity(float opacity, float cosine) {
  constexpr float kSteepest = 0.1f;  // least cosine: beyond it the thickness is constant
  return 1 - std::pow(1 - opacity, 1 / std::max(kSteepest, std::abs(cosine)));
}

void PictureScene::layers(const EyeRays& rays, std::vector<std::size_t>& first,
                          std::vector<SurfacePoint>& points) const {
  std::vector<std::optional<SurfacePoint>> found(rays.size());
  closest(rays, found);
  first.assign(1, 0);
  points.clear();
  for (const std::optional<SurfacePoint>& p : found) {
    if (p) points.push_back(*p);
    first.push_back(points.size());
  }
}

namespace {

/// The part of a ray in a box; empty if near > far.
std::pair<float, float> part_in(const Box3f& box, const Vec3f& origin, const Vec3f& direction, float near, float far) {
  for (int k = 0; k < 3; ++k) {
    if (direction[k] == 0) {
      if (origin[k] < box.lower[k] || origin[k] > box.upper[k]) return {1, 0};
      continue;
    }
    float in = (box.lower[k] - origin[k]) / direction[k], out = (box.upper[k] - origin[k]) / direction[k];
    if (in > out) std::swap(in, out);
    near = std::max(near, in), far = std::min(far, out);
  }
  return {near, far};
}

/// The rays of a batch that meet the box, and their parts inside.
struct RaysInBox {
  std::vector<std::uint32_t> kept;
  std::vector<Vec3f> origins, directions;
  std::vector<float> near, far;

  RaysInBox(const EyeRays& all, const Box3f& box) {
    if (all.origins.size() == 1) origins.push_back(all.origins[0]);
    for (std::uint32_t i = 0; i < all.size(); ++i) {
      const auto [in, out] = part_in(box, all.origin(i), all.directions[i], all.near.empty() ? 0 : all.near[i],
                                     all.far.empty() ? std::numeric_limits<float>::infinity() : all.far[i]);
      if (in > out) continue;
      kept.push_back(i);
      if (all.origins.size() != 1) origins.push_back(all.origin(i));
      directions.push_back(all.directions[i]);
      near.push_back(in), far.push_back(out);
    }
  }
  EyeRays rays() const { return {origins, directions, near, far}; }
};

}  // namespace

PictureFrame frame_of_points(const Box3& box) {
  if (box.empty()) throw DataError("nothing to draw: no finite points");
  if (!(box.diagonal() > 0)) throw DataError("nothing to draw: all points coincide");
  return {box.center(), box.diagonal()};
}

void ClippedScene::closest(const EyeRays& rays, std::span<std::optional<SurfacePoint>> points) const {
  const RaysInBox part(rays, box_);
  std::vector<std::optional<SurfacePoint>> found(part.kept.size());
  if (!part.kept.empty()) scene_.closest(part.rays(), found);
  for (std::optional<SurfacePoint>& p : points) p.reset();
  for (std::size_t k = 0; k < part.kept.size(); ++k) points[part.kept[k]] = found[k];
}

void sort_into_layers(std::vector<RayPoint>& found, std::size_t rays, std::vector<std::size_t>& first,
                      std::vector<SurfacePoint>& points) {
  std::stable_sort(found.begin(), found.end(), [](const RayPoint& a, const RayPoint& b) { return a.ray < b.ray; });
  first.assign(rays + 1, 0);
  points.clear();
  for (const RayPoint& f : found) {
    ++first[f.ray + 1];
    points.push_back(f.point);
  }
  std::partial_sum(first.begin(), first.end(), first.begin());
}

void ClippedScene::layers(const EyeRays& rays, std::vector<std::size_t>& first,
                          std::vector<SurfacePoint>& points) const {
  const RaysInBox part(rays, box_);
  std::vector<std::size_t> own;
  points.clear();
  if (!part.kept.empty()) scene_.layers(part.rays(), own, points);
  first.assign(rays.size() + 1, 0);
  for (std::size_t k = 0; k < part.kept.size(); ++k) first[part.kept[k] + 1] = own[k + 1] - own[k];
  std::partial_sum(first.begin(), first.end(), first.begin());
}

void ClippedScene::blocked(std::span<const ShadowRay> rays, std::span<std::uint8_t> answers) const {
  std::vector<ShadowRay> part;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    answers[i] = 0;
    const auto [in, out] = part_in(box_, rays[i].origin, rays[i].direction, rays[i].near, rays[i].length);
    if (in > out) continue;
    kept.push_back(i);
    part.push_back({rays[i].origin, rays[i].direction, out, in});
  }
  std::vector<std::uint8_t> found(part.size());
  if (!part.empty()) scene_.blocked(part, found);
  for (std::size_t k = 0; k < kept.size(); ++k) answers[kept[k]] = found[k];
}

}  // namespace sansmesh::inline v1
