#include "sansmesh/pictures.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sansmesh/core/index_in.h"
#include "sansmesh/error.h"
#include "sansmesh/jobs/pictures/color_bar.h"
#include "sansmesh/jobs/pictures/draw_objects.h"
#include "sansmesh/jobs/pictures/draw_surface.h"
#include "sansmesh/jobs/pictures/picture_checks.h"
#include "sansmesh/jobs/pictures/picture_curvature.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/points/statistics/sample_confidence.h"
#include "sansmesh/render/scene/color_words.h"
#include "sansmesh/render_options.h"

namespace sansmesh::inline v1 {
namespace {

/// Clouds with fewer samples are drawn as points, since their surface is uncertain.
constexpr std::size_t kFewestOfSurface = 30;

/// Completes options that depend on each other.
PictureOptions completed(PictureOptions o, std::size_t objects) {
  if (o.splats && o.look.plain) {
    o.look.picture.look.shadows = o.look.picture.look.ground = false;
    o.look.picture.quality.occlusion_rays = 0;
    o.look.picture.quality.samples = 1;
  }
  if (objects == 1 && !o.colors.empty())
    if (const auto color = color_of_word(o.colors[0]))
      o.look.picture.look.surface_color = *color, o.look.picture.look.use_colors = false;
  return o;
}

/// Discs around samples have rims that would appear as lines, so lines of a cloud are those of a surface.
bool lines_may_need_surface(const std::vector<PictureObject>& objects, const PictureOptions& o) {
  return o.look.picture.look.lines != PictureLook::Lines::none && objects.size() == 1 && !is_of_lines(objects, o) &&
         !o.translucent() && o.color_by.empty() && !o.look.picture.look.point_radius &&
         o.look.picture.look.wireframe == PictureLook::Wireframe::none && o.look.picture.look.smooth &&
         !is_meshless(objects, o) && objects[0].points.triangles.empty() &&
         objects[0].points.size() >= kFewestOfSurface;
}

/// Returns false for points without a surface; their discs still have silhouettes.
bool draw_lines_of_surface(const PictureObject& object, const PictureOptions& o, const UsePicture& use,
                           RenderResult& result, Progress& progress) {
  PictureOptions by_rays = o;
  by_rays.surface = SurfaceOptions{};
  try {
    draw_surface(object, by_rays, CrestsFrom::samples, use, result, progress);
    return true;
  } catch (const DataError&) {
    return false;
  }
}

/// Colours by the attribute of meshes of clouds; undefined values count as 0.
void color_by_confidence(TriangleMesh& mesh) {
  const Attribute* const confidence = mesh.attributes.find(kConfidence);
  if (!confidence || confidence->components != 1)
    throw DataError("has no attribute confidence: reconstruct the mesh with `confidence`");
  mesh.colors.resize(mesh.vertices.size());
  for (std::size_t v = 0; v < mesh.colors.size(); ++v) {
    const double known = confidence->number(v);
    const Vec3f color = confidence_color(std::isfinite(known) ? static_cast<float>(std::clamp(known, 0.0, 1.0)) : 0.0f);
    for (std::size_t k = 0; k < 3; ++k) mesh.colors[v][k] = index_in<std::uint8_t>(std::round(255 * color[k]), 0, 255);
  }
}

/// Colours by `color_by`, if given.
std::optional<ColorBar> color_mesh(TriangleMesh& mesh, const PictureOptions& o, RenderOptions& picture) {
  if (o.color_by.empty()) return std::nullopt;
  if (o.color_by == kConfidence) {
    color_by_confidence(mesh);
    return confidence_bar();
  }
  if (is_curvature(o.color_by) && !mesh.attributes.find(o.color_by))
    throw ArgumentError("`color_by` with a curvature needs `surface`, or a file with curvature attributes");
  picture.look.shadows = picture.look.ground = false;  // shading would alter the colours
  return color_by_attribute(mesh, o.color_by, o.color_range, o.unit);
}

void draw_mesh(PictureObject object, const PictureOptions& o, const UsePicture& use, RenderResult& result,
               Progress& progress) {
  PointSet& points = object.points;
  check_kinds({points.triangles.empty() ? ObjectKind::points : ObjectKind::mesh}, o);
  with_name(object.name, [&] {
    if (o.cloud.remove_outliers.value_or(false)) leave_out_outliers(points, object.name, result.notes, progress);
    RenderOptions picture = o.look.picture;
    if (wants_curvature(picture)) picture.look.curvature = curvature_of_samples(points, o.cloud, progress);
    TriangleMesh mesh = to_mesh(std::move(points));
    std::optional<ColorBar> bar = color_mesh(mesh, o, picture);
    if (!o.bar) bar.reset();
    reserve_width(picture, bar);
    const Image image = render_mesh(mesh, picture, progress);
    use(0, beside_bar(image, bar, picture), picture);
  });
}

}  // namespace

RenderResult render(std::vector<PictureObject> objects, const PictureOptions& options, const UsePicture& use,
                    Progress& progress) {
  options.validate();
  if (objects.empty()) throw ArgumentError("nothing to draw: no object is given");
  check_objects(objects, options);
  const PictureOptions o = completed(options, objects.size());
  RenderResult result;
  if (is_meshless(objects, o) && !is_of_objects(objects, o))
    draw_surface(std::move(objects[0]), o, CrestsFrom::surface, use, result, progress);
  else if (lines_may_need_surface(objects, o) && draw_lines_of_surface(objects[0], o, use, result, progress))
    return result;
  else if (is_of_objects(objects, o))
    draw_objects(std::move(objects), o, use, result, progress);
  else
    draw_mesh(std::move(objects[0]), o, use, result, progress);
  return result;
}

}  // namespace sansmesh::inline v1
