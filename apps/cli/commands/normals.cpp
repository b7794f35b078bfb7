// Command `normals`: estimates and orients the normals of a cloud.
#include "sansmesh/points.h"

#include <fmt/core.h>

#include <utility>

#include "cli/input/cloud_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "cli/report/mesh_words.h"
#include "sansmesh/io.h"

namespace sansmesh::cli {
namespace {

struct NormalsArguments {
  CloudInput input;
  std::string output;
  bool ascii = false;
  NormalsOptions options;
};

void run_normals(const NormalsArguments& a, Console& console) {
  a.options.validate();
  check_writable(a.output, "points");
  Progress& progress = console.progress();
  ReadReport read;
  const std::string name = a.input.name();
  PointSet given = a.input.read(console, read);
  const NormalsResult made = naming(name, console, [&] { return normals(std::move(given), a.options, progress); });
  console.note(name, made.notes);
  progress.begin("write");
  warn_of_system(a.output, made.points.reference.get(), console);
  write_points(a.output, made.points, {.ascii = a.ascii});
  console.report(a.input.report(read, made.points.size()), "input");
  console.report(made.report);
  console.report(FileReport{a.output}, "output");
  console.print(fmt::format("{} ({}) → {}", name, read.format, a.output));
  console.print(summary_of(made));
}

}  // namespace

Command add_normals(CommandLine& app) {
  CommandLine& c = app.add_subcommand("normals", "Points → points with oriented normals");
  auto shared = std::make_shared<NormalsArguments>();
  NormalsArguments& a = *shared;
  add_cloud_input(c, a.input, "Points, or a mesh or polygon soup");
  add_points_output(c, a.output);
  add_ascii_flag(c, a.ascii);
  add_schema(c, a.options);
  c.footer(std::string(kReadable) +
           "\n\nExamples:\n"
           "  sansmesh normals scan.xyz -o oriented.ply\n"
           "  sansmesh normals scan.xyz -o oriented.ply --neighbours 30 --orient-by up");
  c.announce({report_of<ReadCloud>("input"), report_of<NormalsReport>(), report_of<FileReport>("output")});
  return {&c, [shared](Console& console) { run_normals(*shared, console); }};
}

}  // namespace sansmesh::cli
