#include "sansmesh/jobs/draw_objects.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"
#include "sansmesh/jobs/picture_checks.h"
#include "sansmesh/jobs/picture_curvature.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/mesh/edit/tubes.h"
#include "sansmesh/pictures.h"
#include "sansmesh/points/outliers.h"
#include "sansmesh/points/spacing.h"
#include "sansmesh/render/annotate/picture_notes.h"
#include "sansmesh/render/scene/color_space.h"
#include "sansmesh/render/scene/color_words.h"
#include "sansmesh/render/surface/picture_surfaces.h"

namespace sansmesh::inline v1 {
namespace {

/// Pixels that are left for the objects beside the legend, at least.
constexpr int kLeastBesideLegend = 100;

/// Far from each other in hue, then in lightness as well.
Vec3f object_color(std::size_t number) {
  constexpr std::array<double, 8> kHues{255, 60, 150, 20, 310, 100, 205, 345};
  const std::size_t round = number / kHues.size();
  const double lightness = round % 3 == 0 ? 0.70 : round % 3 == 1 ? 0.50 : 0.83;
  return srgb_of_oklch(lightness, 0.13, kHues[number % kHues.size()] + 22.0 * static_cast<double>(round % 2));
}

/// Lines as tubes, as thin as those of pictures of lines alone.
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

/// An object without a mesh, and what it needs.
struct MeshlessObject {
  SurfaceModel model;
  SurfaceCaster caster;

  explicit MeshlessObject(SurfaceModel made, Progress& progress)
      : model(std::move(made)), caster(model.field(progress), model.balls(), {}) {}
};

/// The scene of a picture, built object by object.
class ObjectScene {
 public:
  ObjectScene(const PictureOptions& options, std::size_t objects, RenderResult& result, Progress& progress)
      : o_(options), objects_(objects), result_(result), progress_(progress) {}

  std::vector<PictureSurface> surfaces;
  std::vector<Vec3> places;
  std::vector<LegendEntry> legend;
  std::vector<ObjectKind> kinds;
  std::unique_ptr<CurvatureField> curvature;  ///< of a single object, where the picture shows it

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
    PictureSurface surface;
    Vec3f mean_color;
    double apart = 0;  ///< of sheets that are one
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
    add_notes(result_.notes, "surface", model.warnings(), object.name);
    const SurfaceRenderOptions look = look_of(k, color, model.colors() != nullptr);
    const auto& samples = model.points().positions;
    for (const Vec3f& p : samples.empty() ? model.balls().centers : samples)
      places.push_back(model.frame().to_input(Vec3(p)));
    return {ObjectKind::function, look,
            surface_in_picture(caster, model.frame(), look.picture.look.use_colors ? model.colors() : nullptr, look),
            look.picture.look.surface_color};
  }

  Drawn mesh(PictureObject& object, std::size_t k, const std::string& color, double opacity) {
    ObjectKind kind = ObjectKind::mesh;
    PointSet& points = object.points;
    if (points.triangles.empty()) kind = object.lines.size() > 0 ? ObjectKind::lines : ObjectKind::points;
    if (kind == ObjectKind::points && o_.cloud.remove_outliers)
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
      apart = 4 * look.picture.look.point_radius.value_or(estimate_spacing(cloud));  // the discs of one sheet
    }
    for (const Vec3f& p : mesh.vertices)
      if (is_finite(p)) places.push_back(mesh.origin + Vec3(p));
    return {kind, look, surface_in_picture(mesh, look.picture),
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
  // Lines alone do not have the colours of the list.
  const bool listed = scene.legend.size() > 1 && o.legend && picture.look.lines != PictureLook::Lines::only;
  const int beside = listed ? legend_width(picture.view.height, scene.legend) : 0;
  if (beside > 0 && picture.view.width < beside + kLeastBesideLegend)
    throw ArgumentError(
        fmt::format("`width = {}` is too narrow: the legend takes {} of it; `legend = false` leaves it out",
                    picture.view.width, beside));
  picture.view.width -= beside;
  std::size_t number = 0;
  for (const ViewDirection& view : turntable(picture.view.direction, o.frames.value_or(1))) {
    picture.view.direction = view;
    Image image = render_surfaces(scene.surfaces, scene.places, o.translucent(), picture, progress);
    const Image paper = paper_beside(picture);
    if (listed) image = beside_legend(image, scene.legend, &paper);
    use(number++, image, picture);
  }
}

void leave_out_outliers(PointSet& points, const std::string& name, std::vector<Note>& notes, Progress& progress) {
  progress.begin("find outliers");
  const std::vector<std::uint8_t> outliers = find_outliers(points, {}, progress);
  const auto count = static_cast<std::size_t>(std::count(outliers.begin(), outliers.end(), std::uint8_t{1}));
  if (count == 0) return;
  if (count == points.size()) throw DataError("`remove_outliers` leaves no samples");
  remove_samples(points, outliers);
  add_notes(notes, "outliers", {counted(count, "sample") + " left out: belong to no surface"}, name);
}

}  // namespace sansmesh::inline v1
