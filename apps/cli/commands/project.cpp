// Command `project`: projects points onto the surface of samples; resamples, denoises and consolidates clouds.
#include "sansmesh/points.h"

#include <fmt/core.h>

#include <utility>

#include "cli/input/cloud_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "cli/line/surface_options.h"
#include "cli/report/mesh_words.h"
#include "sansmesh/io.h"
#include "sansmesh/io/formats.h"

namespace sansmesh::cli {
namespace {

struct ProjectArguments {
  CloudInput input, onto;
  std::string output;
  bool ascii = false;
  ProjectOptions options;
};

void run_project(const ProjectArguments& a, Console& console) {
  const ProjectOptions& options = a.options;
  options.validate();
  check_writable(a.output, "points");
  Progress& progress = console.progress();
  ReadReport read;
  CloudInput input = a.input, samples_of = a.onto;
  const bool itself = samples_of.files.empty();
  if (!itself) samples_of.classes = std::exchange(input.classes, {});  // they select samples
  ProjectInput given{.points = input.read(console, read), .name = input.name()};
  const std::size_t count = given.points.size();
  if (ReadReport read_onto; !itself) {
    given.onto = samples_of.read(console, read_onto);
    given.onto_name = samples_of.name();
  }
  const ProjectResult made = project(std::move(given), options, progress);
  console.note(input.name(), made.notes);
  progress.begin("write");
  warn_of_system(a.output, made.points.reference.get(), console);
  write_points(a.output, made.points, {.ascii = a.ascii});
  console.report(input.report(read, count), "input");
  console.report(made.report);
  console.report(WrittenPoints{a.output, made.points.size()}, "output");

  const SurfaceProjection& r = made.report.moved;
  console.print(fmt::format("{}: {} ({})", input.name(), counted(count, "point"), read.format));
  if (made.report.method != "lop" && !a.options.point_count)
    console.print(fmt::format("moved by {} on average (root mean square {}, at most {}); {} too far from the samples",
                              length(r.mean_move), length(r.rms_move), length(r.largest_move), grouped(r.left_out)));
  console.print(fmt::format("{}: {} by {}{}", a.output, counted(made.points.size(), "point"), made.report.method,
                            made.points.has_normals() ? ", with normals" : ""));
}

}  // namespace

Command add_project(CommandLine& app) {
  CommandLine& c = app.add_subcommand("project", "Points → points on the surface of samples: denoise, resample");
  auto shared = std::make_shared<ProjectArguments>();
  ProjectArguments& a = *shared;
  add_cloud_input(c, a.input, "Points to move");  // --class selects among the samples of --onto, if given
  add_points_output(c, a.output);
  c.add_option("--onto", a.onto.files,
               "Samples of the surface; may be repeated (tiles) [the input itself, which denoises]")
      .reads(endings_read(kPoints))
      .repeated();
  add_ascii_flag(c, a.ascii);
  add_schema(c, a.options);
  add_surface_details(c, a.options.surface, a.options.cloud);
  c.footer(kReadable + surface_list() +
           "\n\nExamples:\n"
           "  sansmesh project noisy.ply -o smooth.ply\n"
           "  sansmesh project probes.xyz --onto scan.ply -o feet.ply --method levin\n"
           "  sansmesh project scan.ply -o dense.ply --point-count 1000000\n"
           "  sansmesh project outliers.ply -o even.ply --method lop --point-count 20000");
  c.announce({report_of<ReadCloud>("input"), report_of<ProjectReport>(), report_of<WrittenPoints>("output")});
  return {&c, [shared](Console& console) { run_project(*shared, console); }};
}

}  // namespace sansmesh::cli
