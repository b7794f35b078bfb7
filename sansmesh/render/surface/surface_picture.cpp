#include "sansmesh/render/surface/surface_picture.h"

#include "sansmesh/data/world_points.h"
#include "sansmesh/render/scene/painter.h"
#include "sansmesh/render/surface/surface_scene.h"

namespace sansmesh::inline v1 {

Image render_surface(const SurfaceCaster& caster, std::span<const Vec3f> points, const ColorField* colors,
                     const SurfaceRenderOptions& options, Progress& progress) {
  options.validate();
  SurfaceRenderOptions own = options;
  if (own.plain) {
    own.picture.look.shadows = own.picture.look.ground = false;
    own.picture.quality.occlusion_rays = 0;
    own.picture.quality.samples = 1;
  }
  const PictureFrame frame = frame_of_points(finite_bounds({}, points));
  std::vector<Vec3f> placed;
  placed.reserve(points.size());
  for (const Vec3f& p : points)
    if (is_finite(p)) placed.push_back(frame.to_picture(Vec3(p)));
  const Camera camera = picture_camera(placed, frame, own.picture);

  progress.begin("preparing");
  const SurfaceScene scene(caster, frame, camera, colors, own);
  return paint_scene(scene, camera, frame, own.picture, !own.plain, placed, 0, progress);
}

}  // namespace sansmesh::inline v1
