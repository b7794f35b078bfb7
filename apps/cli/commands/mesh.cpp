// Command `mesh`: meshes a function file.
#include <fmt/core.h>

#include "cli/input/cloud_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "cli/report/mesh_words.h"
#include "sansmesh/functions.h"
#include "sansmesh/jobs/surfaces/fit_words.h"
#include "sansmesh/mesh_options.h"

namespace sansmesh::cli {
namespace {

struct MeshArguments {
  std::string input;
  MeshOutput output;
  MeshOptions options;
};

void run_mesh(MeshArguments& a, Console& console) {
  a.options.validate();
  a.output.check();
  console.progress().begin("read");
  const SurfaceFunction function = read_function(a.input);
  const auto [mesh, report, notes] =
      naming(a.input, console, [&] { return mesh_of_function(function, a.options, console.progress()); });
  console.note(a.input, notes);
  a.output.write(mesh, console);
  const std::size_t fits = info(function).fits;
  console.report(FileReport{a.input}, "input");
  console.report_value("input.fits", fits);
  console.report(report);
  if (!console.prints_text()) return;

  console.print(fmt::format("{}: {}, {}", a.input, counted(fits, "local fit"), counted(function.samples(), "sample")));
  const MeshTopology topology = measure_topology(mesh);
  print_mesh(a.output.file, mesh, topology.components, topology.closed(), console);
  if (report.simplices > 0) console.print("traversed " + grouped(report.simplices) + " simplices");
  if (a.options.measure_quality) console.print(aspect_words(report));
}

}  // namespace

Command add_mesh(CommandLine& app) {
  CommandLine& c = app.add_subcommand("mesh", "Function file → triangle mesh, closed where it bounds a solid");
  auto a = std::make_shared<MeshArguments>();
  add_function_input(c, a->input);
  add_mesh_output(c, a->output);
  add_mesh_options(c, a->options);
  add_schema(c, a->options, {.only = {"box"}});
  add_schema(c, a->options, {.group = "Mesh", .only = {"block_depth"}});
  c.footer(
      "Examples:\n"
      "  sansmesh mesh scan.smf -o scan-mesh.ply\n"
      "  sansmesh mesh scan.smf -o quick.stl --block-depth 6\n"
      "  sansmesh mesh scan.smf -o part.ply --box 0,0,0,10,10,5\n"
      "  sansmesh mesh scan.smf -o small.glb --triangles 20000 --preview small.png");
  c.announce({report_of<FileReport>("input"), value_of<std::size_t>("input.fits", "Local fits of the function"),
              report_of<MeshReport>()});
  return {&c, [a](Console& console) { run_mesh(*a, console); }};
}

}  // namespace sansmesh::cli
