#include "sansmesh/pictures.h"

#include <vector>

#include "sansmesh/data/world_points.h"
#include "sansmesh/inspect.h"
#include "sansmesh/render/surface/picture_surfaces.h"

namespace sansmesh::inline v1 {
namespace {

constexpr Vec3f kMovedColor{0.94f, 0.55f, 0.12f}, kFixedColor{0.72f, 0.74f, 0.77f};

}  // namespace

Image draw_alignment(const AlignResult& aligned, RenderOptions picture, Progress& progress) {
  picture.look.use_colors = false;
  std::vector<SceneFactory> surfaces;
  std::vector<Vec3> framed;
  for (const TriangleMesh* const mesh : {&aligned.moved, aligned.fixed.get()}) {
    picture.look.surface_color = mesh == &aligned.moved ? kMovedColor : kFixedColor;
    surfaces.push_back(scene_factory(*mesh, picture));
    add_finite_points(mesh->origin, mesh->vertices, framed);
  }
  return render_surfaces(surfaces, framed, false, picture, progress);
}

}  // namespace sansmesh::inline v1
