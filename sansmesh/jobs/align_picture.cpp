#include "sansmesh/pictures.h"

#include <vector>

#include "sansmesh/inspect.h"
#include "sansmesh/render/surface/picture_surfaces.h"

namespace sansmesh::inline v1 {
namespace {

constexpr Vec3f kMovedColor{0.94f, 0.55f, 0.12f}, kFixedColor{0.72f, 0.74f, 0.77f};

}  // namespace

Image draw_alignment(const AlignResult& aligned, RenderOptions picture, Progress& progress) {
  picture.look.use_colors = false;
  std::vector<PictureSurface> surfaces;
  std::vector<Vec3> places;
  for (const TriangleMesh* const mesh : {&aligned.moved, aligned.fixed.get()}) {
    picture.look.surface_color = mesh == &aligned.moved ? kMovedColor : kFixedColor;
    surfaces.push_back(surface_in_picture(*mesh, picture));
    for (const Vec3f& p : mesh->vertices)
      if (is_finite(p)) places.push_back(mesh->origin + Vec3(p));
  }
  return render_surfaces(surfaces, places, false, picture, progress);
}

}  // namespace sansmesh::inline v1
