// sansmesh render --surface: a picture straight from samples.
#include <fmt/core.h>

#include <cmath>
#include <memory>
#include <utility>

#include "color_bar.h"
#include "picture_curvature.h"
#include "render.h"
#include "sansmesh/core/error.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/io/io.h"
#include "sansmesh/model/sample_surface.h"
#include "sansmesh/points/sample_confidence.h"
#include "sansmesh/render/surface_caster.h"
#include "sansmesh/render/surface_picture.h"
#include "sansmesh/surface/curvature_colors.h"
#include "splat_points.h"

namespace sansmesh::cli {
namespace {

/// `mesh`: that whose faces were sampled, if any.
std::unique_ptr<ColorField> make_colors(const RenderArguments& a, const SurfaceModel& model,
                                        std::optional<CurvedVertices> mesh, Progress& progress,
                                        std::optional<ColorBar>& bar) {
  if (a.color_by.empty()) return nullptr;
  const Placement& place = model.place();
  if (a.color_by == kConfidence) {
    if (model.points().size() == 0) throw DataError("there is no confidence without samples, and they were not kept");
    bar = confidence_bar();
    return std::make_unique<ConfidenceColors>(model.points(), place.from_input(model.report().spacing),
                                              place.from_input(model.report().noise));
  }
  CurvatureColorOptions o;
  o.quantity = curvature_quantity(a.color_by);
  if (a.color_range) o.range = curvature_range(*a.color_range, o.quantity, place.unit);
  o.curvature.noise = place.from_input(model.report().noise);
  progress.begin("curvature");
  std::unique_ptr<CurvatureColors> colors;
  if (mesh) {
    const auto scale = static_cast<float>(place.unit / mesh->place.unit);
    for (PrincipalCurvatures& c : mesh->curvatures) c.k1 *= scale, c.k2 *= scale;
    move_to_input(mesh->points, mesh->place);
    move_from_input(mesh->points, place);
    colors = std::make_unique<CurvatureColors>(mesh->points, mesh->curvatures, o);
  } else {
    colors = std::make_unique<CurvatureColors>(model.points(), o, progress);
  }
  // The range is that of all but a few of the samples, or what was asked for.
  bar = curvature_bar(o.quantity, curvature_range(colors->range(), o.quantity, 1 / place.unit), a.unit, true);
  return colors;
}

/// Draws the surface by rays, or by splats.
class SurfacePainter {
 public:
  SurfacePainter(const RenderArguments& arguments, const SurfaceModel& model, const ColorField* colors,
                 const SurfaceRenderOptions& options, Progress& progress)
      : model_(model), colors_(colors) {
    if (arguments.splats) {
      const SplatPoints points = spread_splats(model, *arguments.splats, colors, progress);
      splats_.emplace(points.points, points.stretches, options);
      return;
    }
    SurfaceCastOptions cast;
    cast.normals = model.normals();
    cast.jump = model.traits().jump;
    cast.stored = arguments.stored_rays.value_or(false);
    if (model.projection())
      caster_.emplace(*model.projection(), model.balls(), cast);
    else
      caster_.emplace(model.field(progress), model.balls(), cast);
  }

  Image paint(const SurfaceRenderOptions& options, Progress& progress) const {
    if (splats_) return splats_->render(options, options.steady, progress);
    const std::vector<Vec3f>& samples = model_.points().positions;
    return render_surface(*caster_, samples.empty() ? model_.balls().centers : samples, colors_, options, progress);
  }

  void report(Json& json) const {
    if (splats_) {
      json["splats"] = splats_->size();
      return;
    }
    const CastCounts counts = caster_->counts();
    json["rays"] = {
        {"cast", counts.rays}, {"hit", counts.hits}, {"evaluations", counts.hit_evaluations + counts.miss_evaluations}};
  }

 private:
  const SurfaceModel& model_;
  const ColorField* colors_;
  std::optional<SplatPicture> splats_;
  std::optional<SurfaceCaster> caster_;
};

/// The surface of a function file, or that of samples. `mesh`: with the curvatures that colours are asked for, where
/// the samples are of its faces.
SurfaceModel read_model(const RenderArguments& arguments, std::optional<ReadCloud>& given, ReadReport& read,
                        std::optional<CurvedVertices>& mesh, Console& console) {
  Progress& progress = console.progress();
  if (given) {
    read = given->read;
    return make_surface_model(prepare_cloud(std::move(given->points), arguments.cloud, progress), *arguments.surface,
                              progress);
  }
  progress.begin("read");
  if (arguments.input.is_function()) {
    read.format = "function";
    return make_surface_model(read_function(arguments.input.files[0]));
  }
  PointSet points = arguments.input.read(console, read);
  if (is_curvature(arguments.color_by)) mesh = curved_vertices(points, arguments.cloud, progress);
  PreparedCloud cloud = prepare_cloud(std::move(points), arguments.cloud, progress);
  return arguments.surface ? make_surface_model(std::move(cloud), *arguments.surface, progress)
                           : make_suited_surface(std::move(cloud), progress);
}

}  // namespace

void run_surface_picture(const RenderArguments& arguments, Console& console, std::optional<ReadCloud> cloud) {
  SurfaceRenderOptions options = arguments.options;
  options.validate();
  arguments.picture.check_frames(arguments.frames > 0);
  if (arguments.surface) arguments.surface->validate();
  check_writable(arguments.output, "image");

  Progress& progress = console.progress();
  ReadReport read;
  std::vector<std::string> files;
  try {
    std::optional<CurvedVertices> mesh;
    const SurfaceModel model = read_model(arguments, cloud, read, mesh, console);
    console.warn(arguments.input.name(), model.warnings());
    move_from_input(options, model.place());
    Image written;
    std::optional<ColorBar> bar;
    const std::unique_ptr<ColorField> curvature = make_colors(arguments, model, std::move(mesh), progress, bar);
    if (arguments.no_bar) bar.reset();
    leave_room(options, bar);
    const ColorField* colors = curvature ? curvature.get() : options.use_colors ? model.colors() : nullptr;
    const std::unique_ptr<CurvatureField> bends = !wants_curvature(options) ? nullptr
                                                  : cloud                   ? curvature_at_samples(model, progress)
                                                                            : curvature_of_surface(model, progress);
    options.curvature = bends.get();
    const SurfacePainter painter(arguments, model, colors, options, progress);
    if (arguments.frames == 0) {
      const Image image = beside_bar(painter.paint(options, progress), bar, options);
      written = arguments.picture.write(arguments.output, image, options);
      files.push_back(arguments.output);
    } else {
      options.steady = true;
      std::size_t number = 0;
      for (const ViewDirection& view : turntable(options.view, arguments.frames)) {
        options.view = view;
        const Image image = beside_bar(painter.paint(options, progress), bar, options);
        files.push_back(frame_name(arguments.output, number++));
        if (files.size() > 1) console.keep_frames();
        written = arguments.picture.write(files.back(), image, options);
      }
    }
    const SurfaceReport& report = model.report();
    const SurfaceMethod& method = surface_method(report.method);
    console.say(fmt::format("{}: {}, {}, spacing {}, noise {}", arguments.input.name(),
                            counted(report.samples, "sample"), method.name, length(report.spacing),
                            length(report.noise)));
    if (report.smoothing > 0)
      console.say(fmt::format("weights {:.2f} spacings wide{}", report.smoothing,
                              method.uses_option("order")
                                  ? fmt::format(", order {}, {}", report.order,
                                                counted(static_cast<unsigned>(report.iterations), "iteration"))
                                  : std::string()));
    console.say(files.size() == 1 ? fmt::format("{}: {} × {} pixels", files[0], written.width, written.height)
                                  : fmt::format("{} … {}: {} × {} pixels each", files.front(), files.back(),
                                                written.width, written.height));
    Json json;
    json["input"] = arguments.input.json();
    json["input"]["format"] = read.format;
    json["input"]["samples"] = report.samples;
    json["surface"] = {{"method", method.name},         {"spacing", report.spacing}, {"noise", report.noise},
                       {"smoothing", report.smoothing}, {"order", report.order},     {"iterations", report.iterations}};
    painter.report(json);
    json["output"] = {{"files", files}, {"width", written.width}, {"height", written.height}};
    if (arguments.frames == 0) json["output"]["file"] = arguments.output;
    for (const Progress::Timing& t : progress.timings())
      json["stages"].push_back({{"stage", t.stage}, {"wall_s", t.wall_seconds}, {"cpu_s", t.cpu_seconds}});
    console.say_json(json);
  } catch (const DataError& error) {
    throw FileError(arguments.input.name(), error.what());
  }
  console.print_timings();
}

}  // namespace sansmesh::cli
