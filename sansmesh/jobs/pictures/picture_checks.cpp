#include "sansmesh/jobs/pictures/picture_checks.h"

#include <fmt/core.h>

#include <algorithm>
#include <initializer_list>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/jobs/given_options.h"

namespace sansmesh::inline v1 {
namespace {

void check_counts(const PictureOptions& o, std::size_t objects) {
  for (const auto& [field, count] :
       {std::pair{"color", o.colors.size()}, {"opacity", o.opacities.size()}, {"name", o.names.size()}})
    if (count > objects)
      throw ArgumentError(fmt::format("`{}` is given {} times, for {}", field, count, counted(objects, "object")));
  if ((o.surface || o.splats) && objects != 1) throw ArgumentError("`surface` and `splats` are for one object");
}

void check_meshless(const PictureOptions& o, bool function, bool meshless) {
  const SurfaceRenderOptions& s = o.look;
  if (function && o.surface)
    throw ArgumentError("`surface` is for samples: the surface of a function file is the function");
  if (function && o.cloud.remove_outliers.value_or(false))
    throw ArgumentError("`remove_outliers` is for samples: the input is a function");
  if (meshless)
    refuse({{"smooth = false", !s.picture.look.smooth},
            {"point_radius", s.picture.look.point_radius.has_value()},
            {"wireframe", s.picture.look.wireframe != PictureLook::Wireframe::none}},
           "is for meshes and points, not for surfaces without a mesh");
  else
    refuse({{"quick", s.plain},
            {"exact_shadows", s.exact_shadows},
            {"reflection", s.reflection != 0},
            {"transmission", s.transmission != 0},
            {"refraction_index", s.refraction_index != SurfaceRenderOptions().refraction_index}},
           "is for one surface without a mesh: it needs `surface`");
}

void check_colors(const PictureOptions& o, std::size_t objects, bool meshless, bool of_objects) {
  // For meshes and points it may also be the name of an attribute.
  const bool by_confidence = o.color_by == kConfidence, by_curvature = meshless && is_curvature(o.color_by);
  if (o.color_range && by_curvature && o.color_range->first != -o.color_range->second)
    throw ArgumentError("`color_range` of curvatures is one number, for both signs");
  if (o.color_by.empty()) return;
  if (objects != 1) throw ArgumentError("`color_by` is for one object: `as_one` makes one of several files");
  if (of_objects) throw ArgumentError("`color_by` with `frames` needs `surface`");
  if (meshless && !by_confidence && !by_curvature)
    throw ArgumentError(
        fmt::format("`color_by` of a surface without a mesh must be mean, gaussian, k1, k2 or confidence, not {}",
                    printable(o.color_by, 40)));
}

}  // namespace

bool is_meshless(const std::vector<PictureObject>& objects, const PictureOptions& o) {
  return o.surface || o.splats || (objects.size() == 1 && objects[0].function);
}

bool is_of_lines(const std::vector<PictureObject>& objects, const PictureOptions& o) {
  return !o.surface && !o.splats && objects.size() == 1 && o.color_by.empty() && objects[0].lines.size() > 0;
}

bool is_of_objects(const std::vector<PictureObject>& objects, const PictureOptions& o) {
  if (o.surface || o.splats) return false;
  return objects.size() > 1 || o.translucent() || (o.frames && !is_meshless(objects, o)) || is_of_lines(objects, o);
}

void check_objects(const std::vector<PictureObject>& objects, const PictureOptions& o) {
  const bool meshless = is_meshless(objects, o), of_objects = is_of_objects(objects, o);
  check_counts(o, objects.size());
  check_meshless(o, objects.size() == 1 && objects[0].function, meshless);
  check_colors(o, objects.size(), meshless, of_objects);
  if (objects.size() == 1)
    refuse({{"name", !o.names.empty()}}, "is for the list of several objects: there is one");
  else  // each object would have its own range of curvature
    refuse({{"line_strength", o.look.picture.look.line_strength != RenderOptions().look.line_strength},
            {"curvature_shading", o.look.picture.look.curvature_shading != RenderOptions().look.curvature_shading &&
                                      o.look.picture.look.curvature_shading != 0}},
           "is about curvature, which pictures of several objects do not show");
}

void check_kinds(const std::vector<ObjectKind>& kinds, const PictureOptions& o) {
  const auto none = [&](std::initializer_list<ObjectKind> those) {
    return std::none_of(kinds.begin(), kinds.end(),
                        [&](ObjectKind k) { return std::find(those.begin(), those.end(), k) != those.end(); });
  };
  if (none({ObjectKind::mesh, ObjectKind::lines}))
    refuse({{"smooth = false", !o.look.picture.look.smooth},
            {"wireframe", o.look.picture.look.wireframe != PictureLook::Wireframe::none}},
           "is for meshes: there are no triangles");
  if (none({ObjectKind::points}))
    refuse({{"point_radius", o.look.picture.look.point_radius.has_value()},
            {"remove_outliers", o.cloud.remove_outliers.value_or(false)}},
           "is for points, and there are only meshes");
}

}  // namespace sansmesh::inline v1
