// sansmesh volume isosurface: where a quantity has a value, as a mesh, or as meshes at many moments.
#include "sansmesh/isosurfaces.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "commands.h"
#include "flow_input.h"
#include "option_groups.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "schema_options.h"
#include "simulate_frames.h"
#include "volume_input.h"

namespace sansmesh::cli {
namespace {

struct IsosurfaceArguments {
  VolumeInput input;
  VolumeIsosurfaceOptions options;
  MeshOutput output;
  bool unsteady = false;
  std::vector<double> times;
  IsosurfaceMomentsOptions moments;
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

void run_moments(const IsosurfaceArguments& a, Console& console) {
  check_moments(a.options, a.moments);
  a.output.check();
  require(a.output.preview.empty(), "--preview is not for --unsteady");
  Progress& progress = console.progress();
  VolumeSeries series = open_volume_series(a.input.files, a.input, a.times, progress);
  console.note(series.name, series.notes);
  check_frame_names(a.input, a.output.file, moment_count(series, a.moments));
  const auto write = [&](std::size_t k, const TriangleMesh& mesh) {
    if (k > 0) console.keep_frames();
    write_mesh(motion_frame_name(a.output.file, k), mesh, {.ascii = a.output.ascii});
  };
  const IsosurfaceMomentsResult made = isosurface_moments(series, a.options, a.moments, write, progress);
  const IsosurfaceMomentsReport& r = made.report;
  progress.finish();
  console.note(series.name, made.notes);
  const VolumeModel& first = series.steps[0];
  console.say(method_line(first));
  console.say(fmt::format("{}: {} = {:.6g}{}, {} from {:.6g} to {:.6g}", series.name, first.array_name(), r.value,
                          a.options.value ? "" : " (the middle of the first step's range)",
                          counted(series.steps.size(), "step"), series.times.front(), series.times.back()));
  const auto [least, most] = std::minmax_element(
      r.moments.begin(), r.moments.end(),
      [](const IsosurfaceMoment& x, const IsosurfaceMoment& y) { return x.triangles < y.triangles; });
  console.say(fmt::format("{} … {}: {} meshes with {} to {} triangles", motion_frame_name(a.output.file, 0),
                          motion_frame_name(a.output.file, r.moments.size() - 1), grouped(r.moments.size()),
                          grouped(least->triangles), grouped(most->triangles)));
  Json frames = Json::array();
  std::size_t number = 0;
  for (const IsosurfaceMoment& m : r.moments)
    frames.push_back({{"file", motion_frame_name(a.output.file, number++)},
                      {"time", m.time},
                      {"vertices", m.vertices},
                      {"triangles", m.triangles},
                      {"components", m.components},
                      {"closed", m.closed},
                      {"area", m.area},
                      {"volume", m.volume}});
  console.say_json({{"input", a.input.json()},
                    {"value", r.value},
                    {"steps", series.steps.size()},
                    {"blocks", r.blocks},
                    {"cell", r.cell},
                    {"time_cell", r.time_cell},
                    {"frames", frames}});
  console.print_timings();
}

void run_isosurface(const IsosurfaceArguments& a, Console& console) {
  require(a.unsteady || (a.times.empty() && options_set(a.moments).empty()),
          "--times, --frames and --time-cell need --unsteady");
  if (a.unsteady) return run_moments(a, console);
  a.options.validate();
  a.output.check();
  Progress& progress = console.progress();
  VolumeModel volume = a.input.open(console);
  const VolumeIsosurfaceResult made = isosurface(volume, a.options, progress);
  const TriangleMesh& mesh = made.mesh;
  const IsosurfaceReport& r = made.report.mesh;
  const double value = made.report.value;
  console.note(volume.name(), made.notes);
  a.output.write(mesh, progress);
  progress.finish();

  const auto samples = volume.samples(progress);
  console.say(method_line(volume));
  console.say(fmt::format("{}: {} = {:.6g}{} on {} ({})", volume.name(), volume.array_name(), value,
                          a.options.value ? "" : " (the middle of its range)", counted(samples->size(), "sample"),
                          samples->facts.grid));
  console.say(fmt::format("{}: {}, {} vertices in {}{}", a.output.file, counted(mesh.triangles.size(), "triangle"),
                          grouped(mesh.vertices.size()), counted(r.components, "component"),
                          r.closed ? ", closed" : ", with borders"));
  console.say(r.volume ? fmt::format("area {:.6g}, volume {:.6g}", r.area, *r.volume)
                       : fmt::format("area {:.6g} (--closed gives the volume of what is above the value)", r.area));
  console.say_json({{"input", json_of_volume(a.input, volume, progress)},
                    {"value", value},
                    {"blocks", r.blocks},
                    {"cell", r.cell},
                    {"area", r.area},
                    {"volume", r.volume ? Json(*r.volume) : Json()},
                    {"output",
                     {{"file", a.output.file},
                      {"vertices", mesh.vertices.size()},
                      {"triangles", mesh.triangles.size()},
                      {"components", r.components},
                      {"closed", r.closed}}}});
  console.print_timings();
}

}  // namespace

Command add_volume_isosurface(CommandLine& volume) {
  CommandLine& c = volume.add_subcommand("isosurface", "Volume on any grid → where a quantity has a value, as a mesh");
  auto a = std::make_shared<IsosurfaceArguments>();
  add_volume_input(c, a->input);
  add_schema(c, a->options, {.only = {"value"}});
  add_mesh_output(c, a->output);
  add_schema(c, a->options, {.only = {"carry", "closed"}});
  add_schema(c, a->options.mesh, {.group = "Mesh", .without = {"closed"}});
  c.add_flag(
       "--unsteady", a->unsteady,
       "The volume changes: all steps of the file in time, or several files one after the other, become a surface "
       "in space and time and this a closed mesh at each of many moments, NAME_0000.ply, …")
      .group("Time");
  add_times_option(c, a->times, "Time");
  add_schema(c, a->moments, {.group = "Time"});
  c.footer(std::string(kReadableVolumes) +
           "\n\nOther commands take such a surface as DATA[NAME=VALUE]: csg, section, compare, measure.\n\nExamples:\n"
           "  sansmesh volume isosurface engine.mhd --value 80 -o engine.ply --preview engine.png\n"
           "  sansmesh volume isosurface disk_out_ref.vtu --array Temp --value 600 -o hot.vtp\n"
           "  sansmesh volume isosurface flame_*.vti --unsteady --value 900 --frames 100 -o flame.ply\n"
           "  sansmesh section 'disk_out_ref.vtu[Temp=600]' --axis z -o cut.svg");
  return {&c, [a](Console& console) { run_isosurface(*a, console); }};
}

}  // namespace sansmesh::cli
