// Command `volume isosurface`: isosurfaces of volumes, at one or many moments.
#include "sansmesh/isosurfaces.h"

#include <fmt/core.h>

#include <algorithm>
#include <string>
#include <vector>

#include "cli/input/flow_input.h"
#include "cli/input/volume_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "cli/report/mesh_words.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/jobs/files/frame_names.h"

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

/// Mesh file of a moment.
struct WrittenMoment {
  std::string file;
  IsosurfaceMoment moment;

  static const ReportSchema& schema();
};

constexpr ReportRow kWrittenMoment[] = {reported<&WrittenMoment::file>({.text = "File"}),
                                        reported_inline<&WrittenMoment::moment>()};
constexpr ReportSchema kWrittenMomentSchema{kWrittenMoment};
const ReportSchema& WrittenMoment::schema() { return kWrittenMomentSchema; }

void run_moments(const IsosurfaceArguments& a, Console& console) {
  check_moments(a.options, a.moments);
  a.output.check();
  require(a.output.preview.empty(), "--preview is not for --unsteady");
  Progress& progress = console.progress();
  VolumeSeries series = open_volume_series(a.input.files, a.input, a.times, progress);
  console.note(series.name, series.notes);
  std::vector<std::string> names(moment_count(series, a.moments));
  for (std::size_t k = 0; k < names.size(); ++k) names[k] = motion_frame_name(a.output.file, k);
  check_inputs_stay(a.input.files, names);
  const auto write = [&](std::size_t k, const TriangleMesh& mesh) {
    if (k > 0) console.keep_frames();
    write_mesh(names[k], mesh, {.ascii = a.output.ascii});
  };
  const IsosurfaceMomentsResult made = isosurface_moments(series, a.options, a.moments, write, progress);
  const IsosurfaceMomentsReport& r = made.report;
  console.note(series.name, made.notes);
  console.report(a.input.report(), "input");
  console.report(series);
  console.report(r);
  std::vector<WrittenMoment> frames;
  frames.reserve(r.moments.size());
  for (const IsosurfaceMoment& moment : r.moments) frames.push_back({names[frames.size()], moment});
  console.report(frames, "frames");

  const VolumeModel& first = series.steps[0];
  console.print(summary_of(first, progress));
  console.print(fmt::format("{}: {} = {:.6g}{}, {} from {:.6g} to {:.6g}", series.name, first.array_name(), r.value,
                            a.options.value ? "" : " (the middle of the first step's range)",
                            counted(series.steps.size(), "step"), series.times.front(), series.times.back()));
  const auto [least, most] = std::minmax_element(
      r.moments.begin(), r.moments.end(),
      [](const IsosurfaceMoment& x, const IsosurfaceMoment& y) { return x.triangles < y.triangles; });
  console.print(fmt::format("{} … {}: {} meshes with {} to {} triangles", frames.front().file, frames.back().file,
                            grouped(r.moments.size()), grouped(least->triangles), grouped(most->triangles)));
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
  const IsosurfaceReport& r = made.report.mesh;
  console.note(volume.name(), made.notes);
  a.output.write(made.mesh, console);
  console.report(a.input.report(volume, progress), "input");
  console.report(made.report);

  console.print(summary_of(volume, progress));
  console.print(fmt::format("{} = {:.6g}{}", volume.array_name(), made.report.value,
                            a.options.value ? "" : " (the middle of its range)"));
  print_mesh(a.output.file, made.mesh, r.components, r.closed, console);
  console.print(area_words(r.area, r.volume) + (r.volume ? "" : " (--closed gives the volume above the value)"));
}

}  // namespace

Command add_volume_isosurface(CommandLine& volume) {
  CommandLine& c = volume.add_subcommand("isosurface", "Volume on any grid → isosurface as a mesh");
  auto a = std::make_shared<IsosurfaceArguments>();
  add_volume_input(c, a->input);
  add_schema(c, a->options, {.only = {"value"}});
  add_mesh_output(c, a->output);
  add_schema(c, a->options, {.only = {"carry", "closed"}});
  add_schema(c, a->options.mesh, {.group = "Mesh", .without = {"closed"}});
  c.add_flag("--unsteady", a->unsteady,
             "The volume changes in time: use all steps of the file, or several files as steps, extract a surface "
             "in space and time, and write a closed mesh per moment, NAME_0000.ply, …")
      .group("Time");
  add_times_option(c, a->times, "Time");
  add_schema(c, a->moments, {.group = "Time"});
  c.footer(
      std::string(kReadableVolumes) +
      "\n\nOther commands accept such a surface as DATA[NAME=VALUE]: csg, section, compare, measure.\n\nExamples:\n"
      "  sansmesh volume isosurface engine.mhd --value 80 -o engine.ply --preview engine.png\n"
      "  sansmesh volume isosurface disk_out_ref.vtu --array Temp --value 600 -o hot.vtp\n"
      "  sansmesh volume isosurface flame_*.vti --unsteady --value 900 --frames 100 -o flame.ply\n"
      "  sansmesh section 'disk_out_ref.vtu[Temp=600]' --axis z -o cut.svg");
  c.announce({report_of<ReadVolume>("input"), report_of<VolumeIsosurfaceReport>(), report_of<ReadFiles>("input"),
              report_of<VolumeSeries>(), report_of<IsosurfaceMomentsReport>(), reports_of<WrittenMoment>("frames")});
  return {&c, [a](Console& console) { run_isosurface(*a, console); }};
}

}  // namespace sansmesh::cli
