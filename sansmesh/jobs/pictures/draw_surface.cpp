#include "sansmesh/jobs/pictures/draw_surface.h"

#include <memory>
#include <utility>

#include "sansmesh/error.h"
#include "sansmesh/jobs/pictures/color_bar.h"
#include "sansmesh/jobs/pictures/picture_checks.h"
#include "sansmesh/jobs/pictures/picture_curvature.h"
#include "sansmesh/jobs/pictures/splat_points.h"
#include "sansmesh/jobs/pictures/turntable.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/model/sample_surface.h"
#include "sansmesh/model/surface_model.h"
#include "sansmesh/points/statistics/sample_confidence.h"
#include "sansmesh/render/surface/surface_picture.h"
#include "sansmesh/surface/curvature_words.h"

namespace sansmesh::inline v1 {
namespace {

/// `mesh`: the mesh whose faces were sampled, if any.
std::unique_ptr<ColorField> make_colors(const PictureOptions& o, const SurfaceModel& model,
                                        std::optional<CurvedVertices> mesh, std::optional<ColorBar>& bar,
                                        Progress& progress) {
  if (o.color_by.empty()) return nullptr;
  const LocalFrame& frame = model.frame();
  if (o.color_by == kConfidence) {
    if (model.points().size() == 0) throw DataError("confidence needs the samples, which were not kept");
    bar = confidence_bar();
    return std::make_unique<ConfidenceColors>(model.points(), frame.from_input(model.report().spacing),
                                              frame.from_input(model.report().noise));
  }
  CurvatureColorOptions by;
  by.quantity = curvature_quantity(o.color_by);
  if (o.color_range) by.range = curvature_range(o.color_range->second, by.quantity, frame.unit);
  by.curvature.noise = frame.from_input(model.report().noise);
  progress.begin("curvature");
  std::unique_ptr<CurvatureColors> colors;
  if (mesh) {
    const auto scale = static_cast<float>(frame.unit / mesh->frame.unit);
    for (FittedCurvatures& c : mesh->curvatures) c.k1 *= scale, c.k2 *= scale;
    move_to_input(mesh->points, mesh->frame);
    move_from_input(mesh->points, frame);
    colors = std::make_unique<CurvatureColors>(mesh->points, mesh->curvatures, by);
  } else {
    colors = std::make_unique<CurvatureColors>(model.points(), by, progress);
  }
  // The range covers nearly all samples, or is the given one.
  bar = curvature_bar(by.quantity, curvature_range(colors->range(), by.quantity, 1 / frame.unit), o.unit, true);
  return colors;
}

/// Draws the surface by ray casting or by splats.
class SurfacePainter {
 public:
  SurfacePainter(const PictureOptions& o, const SurfaceModel& model, const ColorField* colors,
                 const SurfaceRenderOptions& look, Progress& progress)
      : model_(model), colors_(colors) {
    if (o.splats) {
      const SplatPoints points = spread_splats(model, *o.splats, colors, progress);
      splats_.emplace(points.points, points.stretches, look.picture);
      return;
    }
    SurfaceCastOptions cast;
    cast.normals = model.normals();
    cast.jump = model.traits().jump;
    cast.stored = o.rays == RayStart::stored;
    if (model.projection())
      caster_.emplace(*model.projection(), model.balls(), cast);
    else
      caster_.emplace(model.field(progress), model.balls(), cast);
  }

  Image paint(const SurfaceRenderOptions& look, Progress& progress) const {
    if (splats_) return splats_->render(look.picture, progress);
    const std::vector<Vec3f>& samples = model_.points().positions;
    return render_surface(*caster_, samples.empty() ? model_.balls().centers : samples, colors_, look, progress);
  }

  void report(RenderReport& report) const {
    if (splats_)
      report.splats = splats_->size();
    else
      report.rays = caster_->counts();
  }

 private:
  const SurfaceModel& model_;
  const ColorField* colors_;
  std::optional<SplatPicture> splats_;
  std::optional<SurfaceCaster> caster_;
};

/// The function, or the surface of the samples. `mesh`: receives curvatures for colours, if the samples are on faces of
/// a mesh.
SurfaceModel model_of(PictureObject& object, const PictureOptions& o, std::optional<CurvedVertices>& mesh,
                      Progress& progress) {
  if (object.function) return make_surface_model(object.function->fitted());
  if (is_curvature(o.color_by)) mesh = curved_vertices(object.points, o.cloud, progress);
  PreparedCloud cloud = prepare_cloud(std::move(object.points), o.cloud, progress);
  return o.surface ? make_surface_model(std::move(cloud), *o.surface, progress)
                   : make_recommended_surface(std::move(cloud), progress);
}

void paint_all(const PictureOptions& o, const SurfaceModel& model, std::optional<CurvedVertices> mesh,
               CrestsFrom crests, const UsePicture& use, RenderReport& report, Progress& progress) {
  SurfaceRenderOptions look = o.look;
  move_from_input(look.picture, model.frame());
  std::optional<ColorBar> bar;
  const std::unique_ptr<ColorField> own = make_colors(o, model, std::move(mesh), bar, progress);
  if (!o.bar) bar.reset();
  reserve_width(look.picture, bar);
  const ColorField* const colors = own ? own.get() : look.picture.look.use_colors ? model.colors() : nullptr;
  if (wants_curvature(look.picture))
    look.picture.look.curvature =
        crests == CrestsFrom::samples ? curvature_at_samples(model, progress) : curvature_of_surface(model, progress);
  const SurfacePainter painter(o, model, colors, look, progress);
  look.picture.view.steady = o.frames.has_value();
  RenderOptions made_with = look.picture;
  made_with.look.curvature = nullptr;  // does not outlive the model
  draw_turntable(made_with, o.frames, use, [&](const RenderOptions& one) {
    look.picture.view = one.view;
    return beside_bar(painter.paint(look, progress), bar, look.picture);
  });
  painter.report(report);
}

}  // namespace

void draw_surface(PictureObject object, const PictureOptions& o, CrestsFrom crests, const UsePicture& use,
                  RenderResult& result, Progress& progress) {
  with_name(object.name, [&] {
    std::optional<CurvedVertices> mesh;
    const SurfaceModel model = model_of(object, o, mesh, progress);
    add_notes(result.notes, model.notes(), object.name);
    paint_all(o, model, std::move(mesh), crests, use, result.report, progress);
    result.report.surface = model.report();
  });
}

}  // namespace sansmesh::inline v1
