// sansmesh mesh: function file in, mesh out.
#include <fmt/core.h>

#include "cloud_input.h"
#include "commands.h"
#include "option_groups.h"
#include "sansmesh/functions.h"
#include "sansmesh/io.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/mesh_options.h"
#include "schema_options.h"

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
  Progress& progress = console.progress();
  progress.begin("read");
  const SurfaceFunction function = read_function(a.input);
  const auto [mesh, report, notes] =
      naming(a.input, console, [&] { return mesh_of_function(function, a.options, progress); });
  console.note(a.input, notes);
  a.output.write(mesh, progress);
  progress.finish();

  const MeshTopology topology = measure_topology(mesh);
  const std::size_t fits = info(function).fits;
  console.say(fmt::format("{}: {}, {}", a.input, counted(fits, "local fit"), counted(function.samples(), "sample")));
  console.say(fmt::format("{}: {}, {} vertices in {}{}", a.output.file, counted(mesh.triangles.size(), "triangle"),
                          grouped(mesh.vertices.size()), counted(topology.components, "component"),
                          topology.closed() ? ", closed" : ", with borders"));
  if (report.simplices > 0) console.say("walked through " + grouped(report.simplices) + " simplices");
  if (a.options.measure_quality) say_aspect_ratios(report, console);
  Json json = {{"input", {{"file", a.input}, {"fits", fits}}},
               {"blocks", report.blocks},
               {"depth", report.block_depth},
               {"output",
                {{"file", a.output.file},
                 {"vertices", mesh.vertices.size()},
                 {"triangles", mesh.triangles.size()},
                 {"components", topology.components},
                 {"closed", topology.closed()},
                 {"mesh_error", report.mesh_error}}}};
  if (report.simplices > 0) json["simplices"] = report.simplices;
  console.say_json(json);
  console.print_timings();
}

}  // namespace

Command add_mesh(CommandLine& app) {
  CommandLine& c = app.add_subcommand("mesh", "Function file → triangle mesh, closed where it bounds a solid");
  auto a = std::make_shared<MeshArguments>();
  c.add_option("input", a->input, "Function, .smf").type_name("FILE").endings({".smf"}).required();
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
  return {&c, [a](Console& console) { run_mesh(*a, console); }};
}

}  // namespace sansmesh::cli
