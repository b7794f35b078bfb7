#include "sansmesh/render/surface/surface_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "sansmesh/box.h"
#include "sansmesh/core/check_range.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"
#include "sansmesh/render/scene/painter.h"
#include "sansmesh/render/surface/surface_scene.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kDepthTile = 32;

}  // namespace

Image render_surface(const SurfaceCaster& caster, std::span<const Vec3f> points, const ColorField* colors,
                     const SurfaceRenderOptions& options, Progress& progress) {
  options.validate();
  SurfaceRenderOptions own = options;
  if (own.plain) {
    own.picture.look.shadows = own.picture.look.ground = false;
    own.picture.quality.occlusion_rays = 0;
    own.picture.quality.samples = 1;
  }
  Box3 box;
  for (const Vec3f& p : points)
    if (is_finite(p)) box.extend(Vec3(p));
  const PictureFrame frame = frame_of_points(box);
  std::vector<Vec3f> placed;
  placed.reserve(points.size());
  for (const Vec3f& p : points)
    if (is_finite(p)) placed.push_back(frame.to_picture(Vec3(p)));
  const Camera camera = picture_camera(placed, frame, own.picture);

  progress.begin("preparing");
  const SurfaceScene scene(caster, frame, camera, colors, own);
  return paint_scene(scene, camera, frame, own.picture, !own.plain, placed, 0, progress);
}

DepthMap surface_depth(const SurfaceCaster& caster, const Camera& camera, int width, int height) {
  check_range("width", width, 1, 16384);
  check_range("height", height, 1, 16384);
  DepthMap map(width, height, std::numeric_limits<float>::infinity());
  const int across = (width + kDepthTile - 1) / kDepthTile, down = (height + kDepthTile - 1) / kDepthTile;
  parallel_for(0, static_cast<std::size_t>(across) * static_cast<std::size_t>(down), 1, [&](std::size_t tile) {
    const int left = static_cast<int>(tile) % across * kDepthTile, top = static_cast<int>(tile) / across * kDepthTile;
    const int right = std::min(left + kDepthTile, width), bottom = std::min(top + kDepthTile, height);
    std::vector<CastRay> rays;
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x) {
        const float u = (2 * static_cast<float>(x) + 1) / static_cast<float>(width) - 1;
        const float v = 1 - (2 * static_cast<float>(y) + 1) / static_cast<float>(height);
        rays.push_back({camera.origin(u, v), camera.direction(u, v)});
      }
    std::vector<CastHit> hits(rays.size());
    caster.cast(rays, hits);
    std::size_t k = 0;
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x, ++k)
        if (hits[k].hit) map.at(x, y) = hits[k].distance;
  });
  return map;
}

}  // namespace sansmesh::inline v1
