#include "sansmesh/render_options.h"

#include <utility>

#include "sansmesh/render/scene/mesh_scene.h"
#include "sansmesh/render/scene/painter.h"

namespace sansmesh::inline v1 {

Image render_mesh(const TriangleMesh& mesh, const RenderOptions& options, Progress& progress) {
  options.validate();
  Subject subject = make_subject(mesh, options);
  const float radius = subject.radius;
  const float below = subject.mesh.normals.empty() ? radius : 0;  // balls extend below the lowest point, discs hardly
  const PictureFrame frame = subject.frame;
  const Camera camera = picture_camera(subject.mesh.vertices, frame, options, radius);
  const MeshScene scene(std::move(subject), options, camera);
  return paint_scene(scene, camera, frame, options, true, scene.points(), below, progress);
}

Image render_mesh(const TriangleMesh& mesh, const RenderOptions& options) {
  Progress progress;
  return render_mesh(mesh, options, progress);
}

}  // namespace sansmesh::inline v1
