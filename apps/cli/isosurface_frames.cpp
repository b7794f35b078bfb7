#include "isosurface_frames.h"

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "command_line.h"
#include "flow_input.h"
#include "option_values.h"
#include "sansmesh/core/error.h"
#include "sansmesh/dataset/isosurface_in_time.h"
#include "sansmesh/io/io.h"
#include "sansmesh/mesh/mesh_size.h"
#include "sansmesh/mesh/mesh_topology.h"
#include "sansmesh/mesh/simplify.h"
#include "sansmesh/polygonize/space_time_surface.h"
#include "simulate_frames.h"

namespace sansmesh::cli {
namespace {

/// Default mesh error in spacings, as of surfaces of one moment.
constexpr double kFrameError = 0.02;

/// The steps of a series, all kept.
class IsosurfaceSeries {
 public:
  IsosurfaceSeries(const VolumeInput& input, const std::vector<double>& times, Console& console) {
    const bool files = input.files.size() > 1;
    if (!times.empty() && !files) throw ArgumentError("--times needs --unsteady and several files");
    if (!files && input.read.time_step > 0) throw ArgumentError("`time_step`: --unsteady takes all steps of the file");
    for (const std::string& file : input.files)
      if (!std::filesystem::exists(file)) throw FileError(file, "no such file");
    add(input, 0, console);
    times_ = files ? times_of_files(times, input.files.size()) : volumes_[0]->dataset().times();
    if (times_.size() < 2)
      throw FileError(input.name(), "holds one step in time: nothing changes (leave out --unsteady)");
    for (std::size_t i = 1; i < times_.size(); ++i) add(input, i, console);
  }

  OpenVolume& first() { return *volumes_[0]; }
  std::size_t size() const { return volumes_.size(); }

  std::vector<IsosurfaceStep> steps() {
    std::vector<IsosurfaceStep> steps;
    for (std::size_t i = 0; i < volumes_.size(); ++i) {
      OpenVolume& v = *volumes_[i];
      steps.push_back({times_[i], v.samples(), v.field(), [&v](std::size_t n) { return v.sample_value(n); }});
    }
    return steps;
  }

 private:
  void add(const VolumeInput& input, std::size_t i, Console& console) {
    const bool files = input.files.size() > 1;
    auto step = std::make_unique<VolumeInput>(input);
    step->files = {input.files[files ? i : 0]};
    if (!files) step->read.time_step = i;
    if (i > 0) {  // array and method are those of the first
      step->array = inputs_[0]->array;
      step->reconstruction = volumes_[0]->report().options;
    }
    inputs_.push_back(std::move(step));
    volumes_.push_back(std::make_unique<OpenVolume>(*inputs_.back(), console));
    if (i > 0) return;
    OpenVolume& v = *volumes_[0];
    const DatasetArray& array = v.dataset().array(v.choice().array);
    if (array.components > 1 && !v.choice().component && !v.choice().magnitude)
      throw ArgumentError(fmt::format("`array`: {} has {} components: choose one ({}:0, {}:magnitude, …)", array.name,
                                      array.components, array.name, array.name));
    if (inputs_[0]->array.empty()) inputs_[0]->array = v.choice().array;
    v.field();  // its method
  }

  std::vector<std::unique_ptr<VolumeInput>> inputs_;  ///< those of the volumes, which refer to them
  std::vector<std::unique_ptr<OpenVolume>> volumes_;
  std::vector<double> times_;
};

/// Inputs are not to be lost: frames get names that nobody typed.
void check_frame_names(const VolumeInput& input, const std::string& output, std::size_t frames) {
  std::error_code ignored;
  std::set<std::filesystem::path> inputs;
  for (const std::string& file : input.files) inputs.insert(std::filesystem::weakly_canonical(file, ignored));
  for (std::size_t k = 0; k < frames; ++k)
    if (const std::string file = motion_frame_name(output, k);
        inputs.contains(std::filesystem::weakly_canonical(file, ignored)))
      throw FileError(file, "is an input, which a result would overwrite");
}

}  // namespace

void IsosurfaceFrames::check() const {
  require(unsteady || (times.empty() && !frames && !time_cell), "--times, --frames and --time-cell need --unsteady");
  require(!frames || (*frames >= 2 && *frames <= 100'000), "--frames must lie in 2..100000");
}

void add_isosurface_frames(CommandLine& c, IsosurfaceFrames& f) {
  const char* const group = "Time";
  c.add_flag(
       "--unsteady", f.unsteady,
       "The volume changes: all steps of the file in time, or several files one after the other, become a surface "
       "in space and time and this a closed mesh at each of many moments, NAME_0000.ply, …")
      .group(group);
  add_times_option(c, f.times, group);
  c.add_option("--frames", f.frames, "With --unsteady: moments from the first step to the last [as many as steps]")
      .type_name("COUNT")
      .group(group);
  c.add_option("--time-cell", f.time_cell,
               "With --unsteady: how long the smallest blocks last [the shortest time between steps]")
      .type_name("TIME")
      .group(group);
}

void write_isosurface_frames(const VolumeInput& input, std::optional<double> value, const IsosurfaceOptions& options,
                             const IsosurfaceFrames& frames, const MeshOutput& output, Console& console) {
  options.validate();
  output.check();
  require(output.preview.empty(), "--preview is not for --unsteady");
  IsosurfaceSeries series(input, frames.times, console);
  OpenVolume& first = series.first();
  const DatasetArray& array = first.dataset().array(first.choice().array);
  if (!value && array.components > 1) throw ArgumentError("--value is needed for arrays of several components");
  const double v = value ? *value : first.model().middle_value();
  const std::size_t count = frames.frames.value_or(series.size());
  check_frame_names(input, output.file, count);

  std::unique_ptr<IsosurfaceInTime> field;
  try {
    field = std::make_unique<IsosurfaceInTime>(series.steps(), v);
  } catch (const DataError& error) {
    throw FileError(input.name(), error.what());
  } catch (const ArgumentError& error) {
    throw FileError(input.name(), error.what());
  }
  const Placement& place = field->place();
  const double spacing = field->median_spacing();
  SpaceTimeOptions cut;
  cut.cell = options.cell ? place.from_input(*options.cell) : spacing;
  cut.time_cell = frames.time_cell.value_or(field->shortest_step());
  console.progress().begin("find surface");
  const SpaceTimeSurface surface(*field, cut, console.progress());
  CollapseOptions simplify;
  simplify.error = options.mesh_error ? place.from_input(*options.mesh_error) : kFrameError * spacing;
  simplify.triangles = options.triangles.value_or(0);

  Json written = Json::array();
  std::vector<std::string> warnings;
  std::size_t least = 0, most = 0;
  const TimeRange times = field->times();
  console.progress().begin("cut frames", count);
  for (std::size_t k = 0; k < count; ++k) {
    const double u = static_cast<double>(k) / static_cast<double>(count - 1);
    const double t = k + 1 == count ? times.last : times.first + u * (times.last - times.first);
    TriangleMesh mesh = surface.slice(t);
    Progress quiet;
    if (!mesh.triangles.empty()) simplify_mesh(mesh, simplify, quiet);
    move_to_input(mesh, place);
    const std::string file = motion_frame_name(output.file, k);
    if (mesh.triangles.empty()) warnings.push_back(fmt::format("there is no surface at the moment {:.6g}", t));
    if (k > 0) console.keep_frames();
    write_mesh(file, mesh, {.ascii = output.ascii});
    const MeshTopology topology = measure_topology(mesh);
    const MeshSize size = measure_size(mesh);
    written.push_back({{"file", file},
                       {"time", t},
                       {"vertices", mesh.vertices.size()},
                       {"triangles", mesh.triangles.size()},
                       {"components", topology.components},
                       {"closed", topology.closed()},
                       {"area", size.area},
                       {"volume", size.volume}});
    least = k == 0 ? mesh.triangles.size() : std::min(least, mesh.triangles.size());
    most = std::max(most, mesh.triangles.size());
    console.progress().advance();
  }
  console.progress().finish();
  if (options.triangles && most > *options.triangles)
    warnings.push_back(counted(most, "triangle") + " instead of " + grouped(*options.triangles) + " in some frames");
  console.warn(input.name(), warnings);
  first.say_method();
  console.say(fmt::format("{}: {} = {:.6g}{}, {} from {:.6g} to {:.6g}", input.name(), first.array_name(), v,
                          value ? "" : " (the middle of the first step's range)", counted(series.size(), "step"),
                          times.first, times.last));
  console.say(fmt::format("{} … {}: {} meshes with {} to {} triangles", motion_frame_name(output.file, 0),
                          motion_frame_name(output.file, count - 1), grouped(count), grouped(least), grouped(most)));
  console.say_json({{"input", input.json()},
                    {"value", v},
                    {"steps", series.size()},
                    {"blocks", surface.blocks()},
                    {"cell", place.to_input(surface.cell())},
                    {"time_cell", surface.time_cell()},
                    {"frames", written}});
  console.print_timings();
}

}  // namespace sansmesh::cli
