// Isosurfaces of a volume that changes in time, as meshes at many moments.
#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "sansmesh/core/check_range.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/dataset/isosurface_in_time.h"
#include "sansmesh/error.h"
#include "sansmesh/isosurfaces.h"
#include "sansmesh/jobs/volumes/volume_state.h"
#include "sansmesh/mesh/edit/simplify.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/polygonize/space_time/space_time_surface.h"

namespace sansmesh::inline v1 {
namespace {

/// Default mesh error in spacings, as for steady isosurfaces.
constexpr double kMomentError = 0.02;

std::unique_ptr<IsosurfaceInTime> field_in_time(const VolumeSeries& series, double value, std::vector<Note>& notes,
                                                Progress& progress) {
  std::vector<IsosurfaceStep> steps;
  for (std::size_t i = 0; i < series.steps.size(); ++i) {
    const VolumeModel& v = series.steps[i];
    const auto field = v.field(progress, notes);
    steps.push_back({series.times[i], v.samples(progress), field, reconstructed_samples(v, *field)});
  }
  try {
    return std::make_unique<IsosurfaceInTime>(std::move(steps), value);
  } catch (const DataError& error) {
    throw DataError(printable(series.name, 200) + ": " + error.what());
  } catch (const ArgumentError& error) {  // the data are at fault: steps do not match
    throw DataError(printable(series.name, 200) + ": " + error.what());
  }
}

IsosurfaceMoment measured_moment(const TriangleMesh& mesh, double time) {
  const MeshTopology topology = measure_topology(mesh);
  const MeshSize size = measure_size(mesh);
  return {.time = time,
          .vertices = mesh.vertices.size(),
          .triangles = mesh.triangles.size(),
          .components = topology.components,
          .closed = topology.closed(),
          .area = size.area,
          .volume = size.volume};
}

}  // namespace

const OptionSchema& IsosurfaceMomentsOptions::schema() {
  using O = IsosurfaceMomentsOptions;
  static constexpr OptionRow rows[] = {
      option<&O::frames>({.text = "With `unsteady`: number of moments from the first step to the last",
                          .from_data = "as many as steps",
                          .range = {.least = 2, .most = 100'000}}),
      option<&O::time_cell>({.text = "With `unsteady`: duration of the smallest blocks",
                             .unit = "time",
                             .from_data = "the shortest time between steps",
                             .range = positive()})};
  return option_schema<rows>();
}

void check_moments(const VolumeIsosurfaceOptions& options, const IsosurfaceMomentsOptions& moments) {
  options.validate();
  validate_options(moments);
  const VolumeIsosurfaceOptions defaults;
  check_argument(options.carry == defaults.carry && !options.mesh.closed &&
                     options.mesh.components.kind == ComponentChoice::Kind::all,
                 "`carry`, `closed` and `components` do not apply to `unsteady`: its meshes are closed, without other "
                 "arrays");
}

std::size_t moment_count(const VolumeSeries& series, const IsosurfaceMomentsOptions& moments) {
  return moments.frames.value_or(series.steps.size());
}

IsosurfaceMomentsResult isosurface_moments(const VolumeSeries& series, const VolumeIsosurfaceOptions& options,
                                           const IsosurfaceMomentsOptions& moments,
                                           const std::function<void(std::size_t, const TriangleMesh&)>& use,
                                           Progress& progress) {
  check_moments(options, moments);
  const std::size_t count = moment_count(series, moments);
  IsosurfaceMomentsResult result;
  IsosurfaceMomentsReport& r = result.report;
  r.value = series.steps.at(0).value_or_middle(options.value);
  const auto field = field_in_time(series, r.value, result.notes, progress);
  r.reconstruction = series.steps[0].report();
  const LocalFrame& frame = field->frame();
  SpaceTimeOptions cut;
  cut.cell = options.mesh.cell ? frame.from_input(*options.mesh.cell) : field->median_spacing();
  cut.time_cell = moments.time_cell.value_or(field->shortest_step());
  progress.begin("find surface");
  const SpaceTimeSurface surface(*field, cut, progress);
  r.blocks = surface.blocks(), r.cell = frame.to_input(surface.cell()), r.time_cell = surface.time_cell();
  CollapseOptions simplify;
  simplify.error =
      options.mesh.mesh_error ? frame.from_input(*options.mesh.mesh_error) : kMomentError * field->median_spacing();
  simplify.triangles = options.mesh.triangles.value_or(0);

  const TimeRange times = field->times();
  std::size_t most = 0;
  progress.begin("cut frames", count);
  for (std::size_t k = 0; k < count; ++k) {
    const double u = static_cast<double>(k) / static_cast<double>(count - 1);
    const double t = k + 1 == count ? times.last : times.first + u * (times.last - times.first);
    TriangleMesh mesh = surface.slice(t);
    Progress quiet;
    if (!mesh.triangles.empty()) simplify_mesh(mesh, simplify, quiet);
    move_to_input(mesh, frame);
    if (mesh.triangles.empty())
      result.notes.push_back(
          {.code = "no_surface", .text = fmt::format("there is no surface at time {:.6g}", t), .of = series.name});
    r.moments.push_back(measured_moment(mesh, t));
    most = std::max(most, mesh.triangles.size());
    use(k, mesh);
    progress.advance();
  }
  if (options.mesh.triangles && most > *options.mesh.triangles)
    result.notes.push_back({.code = "more_triangles",
                            .text = fmt::format("{} instead of {} in some frames", counted(most, "triangle"),
                                                grouped(*options.mesh.triangles)),
                            .of = series.name});
  return result;
}

const ReportSchema& IsosurfaceMoment::schema() {
  static constexpr ReportRow rows[] = {reported<&IsosurfaceMoment::time>({.text = "Time"}),
                                       reported<&IsosurfaceMoment::vertices>({.text = "Vertices"}),
                                       reported<&IsosurfaceMoment::triangles>({.text = "Triangles"}),
                                       reported<&IsosurfaceMoment::components>({.text = "Connected components"}),
                                       reported<&IsosurfaceMoment::closed>({.text = "Whether the mesh is closed"}),
                                       reported<&IsosurfaceMoment::area>({.text = "Area", .unit = "length²"}),
                                       reported<&IsosurfaceMoment::volume>({.text = "Volume", .unit = "length³"})};
  return report_schema<rows>();
}

const ReportSchema& IsosurfaceMomentsReport::schema() {
  static constexpr ReportRow rows[] = {
      reported<&IsosurfaceMomentsReport::value>({.text = "Isovalue", .unit = "unit of the array"}),
      reported<&IsosurfaceMomentsReport::blocks>({.text = "Blocks in space and time"}),
      reported<&IsosurfaceMomentsReport::cell>({.text = "Edge of the smallest blocks", .unit = "length"}),
      reported<&IsosurfaceMomentsReport::time_cell>(
          {.text = "Duration of the smallest blocks", .unit = "unit of the times"}),
      reported<&IsosurfaceMomentsReport::moments>({.name = "frames", .text = "Meshes in order"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
