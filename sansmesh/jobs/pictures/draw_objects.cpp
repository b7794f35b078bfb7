#include "sansmesh/jobs/pictures/draw_objects.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/data/world_points.h"
#include "sansmesh/error.h"
#include "sansmesh/jobs/pictures/color_bar.h"
#include "sansmesh/jobs/pictures/picture_checks.h"
#include "sansmesh/jobs/pictures/picture_curvature.h"
#include "sansmesh/jobs/pictures/turntable.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/mesh/edit/tubes.h"
#include "sansmesh/pictures.h"
#include "sansmesh/points/cleaning/outliers.h"
#include "sansmesh/points/statistics/spacing.h"
#include "sansmesh/render/annotate/picture_notes.h"
#include "sansmesh/render/scene/color_space.h"
#include "sansmesh/render/scene/color_words.h"
#include "sansmesh/render/surface/picture_surfaces.h"

namespace sansmesh::inline v1 {
namespace {

/// Least width of the picture beside the legend, pixels.

/// Colours that differ in hue, then in lightness.
Vec3f object_color(std::size_t number) {
  constexpr std::array<double, 8> kHues{255, 60, 150, 20, 310, 100, 205, 345};
  const std::size_t round = number / kHues.size();
  const double lightness = round % 3 == 0 ? 0.70 : round % 3 == 1 ? 0.50 : 0.83;
  return srgb_of_oklch(lightness, 0.13, kHues[number % kHues.size()] + 22.0 * static_cast<double>(round % 2));
}

/// Lines as tubes with the radius of line pictures.
TriangleMesh tubes_of(const PolylineSet& lines) {
  const double radius = tube_radius(lines);
  return tubes(lines, {.radius = radius, .sides = 8, .least_step = 0.5 * radius});
}

PointSet tube_samples(const TriangleMesh& mesh) {
  PointSet points;
  points.origin = mesh.origin, points.positions = mesh.vertices;
  points.normals = mesh.normals, points.triangles = mesh.triangles;
  return points;
}

Vec3f mean_of(const std::vector<std::array<std::uint8_t, 3>>& colors) {
  Vec3 sum;
  for (const auto& c : colors) sum += Vec3{double(c[0]), double(c[1]), double(c[2])};
  return Vec3f(sum / (255.0 * static_cast<double>(colors.size())));
}

/// An object without a mesh, with its model.
struct MeshlessObject {
  SurfaceModel model;
  SurfaceCaster caster;

  explicit MeshlessObject(SurfaceModel made, Progress& progress)
      : model(std::move(made)), caster(model.field(progress), model.balls(), {}) {}
};

/// Scene of a picture, built object by object.
class ObjectScene {
 public:
  ObjectScene(const PictureOptions& options, std::size_t objects, RenderResult& result, Progress& progress)
      : o_(options), objects_(objects), result_(result), progress_(progress) {}

  std::vector<SceneFactory> surfaces;
  std::vector<Vec3> framed;
  std::vector<LegendEntry> legend;
  std::vector<ObjectKind> kinds;
  std::unique_ptr<CurvatureField> curvature;  ///< curvature of a single object, if the picture needs it

  void add(PictureObject object) {
    const std::size_t k = surfaces.size();
    const std::string color = k < o_.colors.size() ? o_.colors[k] : kAutoColor;
    const double opacity = k < o_.opacities.size() ? o_.opacities[k] : 1;
    Drawn drawn = object.function ? function(object, k, color) : mesh(object, k, color, opacity);
    surfaces.push_back(opacity < 1 ? translucent(std::move(drawn.surface), opacity, drawn.apart)
                                   : std::move(drawn.surface));
    const std::string title = k < o_.names.size() ? o_.names[k] : object.title.empty() ? object.name : object.title;
    kinds.push_back(drawn.kind);
    legend.push_back({drawn.mean_color, title});
    result_.report.objects.push_back(
        {drawn.kind, title,
         drawn.look.picture.look.use_colors ? kOwnColor : hex_of_color(drawn.look.picture.look.surface_color),
         opacity});
  }

 private:
  struct Drawn {
    ObjectKind kind;
    SurfaceRenderOptions look;
    SceneFactory surface;
    Vec3f mean_color;
    double apart = 0;  ///< distance below which sheets count as one
  };

  SurfaceRenderOptions look_of(std::size_t k, const std::string& color, bool has_colors) const {
    SurfaceRenderOptions look = o_.look;
    look.picture.look.use_colors = has_colors && (color == kAutoColor || color == kOwnColor);
    if (look.picture.look.use_colors) return look;
    if (color == kAutoColor && objects_ > 1) look.picture.look.surface_color = object_color(k);
    if (const auto chosen = color_of_word(color)) look.picture.look.surface_color = *chosen;
    return look;
  }

  Drawn function(PictureObject& object, std::size_t k, const std::string& color) {
    meshless_.push_back(std::make_unique<MeshlessObject>(make_surface_model(object.function->fitted()), progress_));
    const auto& [model, caster] = *meshless_.back();
    add_notes(result_.notes, model.notes(), object.name);
    const SurfaceRenderOptions look = look_of(k, color, model.colors() != nullptr);
    const auto& samples = model.points().positions;
    for (const Vec3f& p : samples.empty() ? model.balls().centers : samples)
      framed.push_back(model.frame().to_input(Vec3(p)));
    return {ObjectKind::function, look,
            scene_factory(caster, model.frame(), look.picture.look.use_colors ? model.colors() : nullptr, look),
            look.picture.look.surface_color};
  }

  Drawn mesh(PictureObject& object, std::size_t k, const std::string& color, double opacity) {
    ObjectKind kind = ObjectKind::mesh;
    PointSet& points = object.points;
    if (points.triangles.empty()) kind = object.lines.size() > 0 ? ObjectKind::lines : ObjectKind::points;
    if (kind == ObjectKind::points && o_.cloud.remove_outliers.value_or(false))
      leave_out_outliers(points, object.name, result_.notes, progress_);
    const bool curved = objects_ == 1 && wants_curvature(o_.look.picture), lines = kind == ObjectKind::lines;
    if (curved && !lines) curvature = curvature_of_samples(points, o_.cloud, progress_);
    const TriangleMesh mesh = lines ? tubes_of(object.lines) : to_mesh(std::move(points));
    if (curved && lines) curvature = curvature_of_samples(tube_samples(mesh), o_.cloud, progress_);
    const SurfaceRenderOptions look =
        look_of(k, color, mesh.colors.size() == mesh.vertices.size() && !mesh.colors.empty());
    double apart = 0;
    if (mesh.triangles.empty() && opacity < 1) {
      PointSet cloud;
      cloud.positions = mesh.vertices;
      apart = 4 * look.picture.look.point_radius.value_or(estimate_spacing(cloud));  // discs of one sheet
    }
    add_finite_points(mesh.origin, mesh.vertices, framed);
    return {kind, look, scene_factory(mesh, look.picture),
            look.picture.look.use_colors ? mean_of(mesh.colors) : look.picture.look.surface_color, apart};
  }

  const PictureOptions& o_;
  std::size_t objects_;
  RenderResult& result_;
  Progress& progress_;
  std::vector<std::unique_ptr<MeshlessObject>> meshless_;
};

}  // namespace

void draw_objects(std::vector<PictureObject> objects, const PictureOptions& o, const UsePicture& use,
                  RenderResult& result, Progress& progress) {
  ObjectScene scene(o, objects.size(), result, progress);
  for (PictureObject& object : objects) {
    const std::string name = object.name;
    with_name(name, [&] { scene.add(std::move(object)); });
  }
  check_kinds(scene.kinds, o);
  RenderOptions picture = o.look.picture;
  picture.view.steady = o.frames.has_value();
  picture.look.curvature = std::move(scene.curvature);
  // Pictures of lines only do not have the colours of the legend.
  const bool listed = scene.legend.size() > 1 && o.legend && picture.look.lines != PictureLook::Lines::only;
  if (listed) reserve_width(picture, legend_width(picture.view.height, scene.legend), "the legend", "legend");
  draw_turntable(picture, o.frames, use, [&](const RenderOptions& one) {
    Image image = render_surfaces(scene.surfaces, scene.framed, o.translucent(), one, progress);
    const Image paper = annotation_background(one);
    return listed ? with_legend(image, scene.legend, &paper) : image;
  });
}

void leave_out_outliers(PointSet& points, const std::string& name, std::vector<Note>& notes, Progress& progress) {
  progress.begin("find outliers");
  const std::vector<std::uint8_t> outliers = find_outliers(points, {}, progress);
  const auto count = static_cast<std::size_t>(std::count(outliers.begin(), outliers.end(), std::uint8_t{1}));
  if (count == 0) return;
  if (count == points.size()) throw DataError("`remove_outliers` leaves no samples");
  remove_samples(points, outliers);
  add_notes(notes, "outliers", {counted(count, "sample") + " dropped: stray samples"}, name);
}

}  // namespace sansmesh::inline v1
