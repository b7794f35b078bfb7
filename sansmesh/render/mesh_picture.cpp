#include "sansmesh/render/mesh_picture.h"

#include <utility>

#include "sansmesh/render/mesh_scene.h"
#include "sansmesh/render/painter.h"

namespace sansmesh {

Image render_mesh(const TriangleMesh& mesh, const RenderOptions& options, Progress& progress) {
  options.validate();
  Subject subject = make_subject(mesh, options);
  const float radius = subject.radius;
  const float below = subject.mesh.normals.empty() ? radius : 0;  // balls reach below the lowest point, discs hardly
  const Camera camera = frame_camera(subject.mesh.vertices, options.view, options.up, options.field_of_view,
                                     static_cast<double>(options.width) / options.height, kPictureMargin, radius);
  const MeshScene scene(std::move(subject), options, camera.backward);
  Painter painter(scene, camera, options);
  if (options.ground) painter.add_ground(scene.points(), below);
  return painter.paint(progress);
}

Image render_mesh(const TriangleMesh& mesh, const RenderOptions& options) {
  Progress progress;
  return render_mesh(mesh, options, progress);
}

}  // namespace sansmesh
