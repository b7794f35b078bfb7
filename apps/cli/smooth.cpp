// sansmesh smooth: noise taken off a mesh.
#include "sansmesh/repair.h"

#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "commands.h"
#include "mesh_words.h"
#include "option_groups.h"
#include "sansmesh/io.h"
#include "sansmesh/mesh_measures.h"
#include "schema_options.h"

namespace sansmesh::cli {
namespace {

struct SmoothArguments {
  std::string input;
  MeshOutput output;
  SmoothOptions options;
};

void run_smooth(const SmoothArguments& a, Console& console) {
  a.options.validate();
  a.output.check();
  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  TriangleMesh read_in = read_mesh(a.input, &read);
  console.warn(a.input, read.warnings);
  const SmoothResult made = smooth(std::move(read_in), a.options, progress);
  const TriangleMesh& mesh = made.mesh;
  const SmoothReport& r = made.report;
  console.note(a.input, made.notes);
  console.warn(a.input, loss_words(read, a.output.file, mesh));
  a.output.write(mesh, progress);
  progress.finish();

  console.say(fmt::format("{}: {}, {} vertices, edges {} long on average", a.input,
                          counted(mesh.triangles.size(), "triangle"), grouped(r.vertices), length(r.mean_edge)));
  console.say(
      fmt::format("moved by {} (root mean square), at most {}; {} at borders and edges of three triangles stayed",
                  length(r.rms_move), length(r.largest_move), grouped(r.fixed)));
  const auto change = [](double before, double after) { return 100 * (after - before) / std::abs(before); };
  std::string size = fmt::format("area {:+.3f} %", change(r.area_before, r.area_after));
  if (r.volume_before && r.volume_after)
    size += fmt::format(", volume {:+.3f} %", change(std::abs(*r.volume_before), std::abs(*r.volume_after)));
  console.say(size);
  console.say(fmt::format("{}: {}{}", a.output.file, counted(static_cast<std::size_t>(r.iterations), "round"),
                          a.options.creases ? fmt::format(", creases of more than {:.0f}° kept", r.crease_angle) : ""));
  Json json = {
      {"input",
       {{"file", a.input}, {"vertices", r.vertices}, {"triangles", mesh.triangles.size()}, {"mean_edge", r.mean_edge}}},
      {"iterations", r.iterations},
      {"moved", {{"rms", r.rms_move}, {"max", r.largest_move}, {"fixed", r.fixed}}},
      {"area", {{"before", r.area_before}, {"after", r.area_after}}},
      {"volume", {{"before", r.volume_before}, {"after", r.volume_after}}},
      {"output", output_json(a.output.file, mesh, measure_topology(mesh))}};
  if (a.options.creases) json["crease_angle_deg"] = r.crease_angle;
  console.say_json(json);
  console.print_timings();
}

}  // namespace

Command add_smooth(CommandLine& app) {
  CommandLine& c = app.add_subcommand("smooth", "Mesh → mesh without its noise, its volume or its creases kept");
  auto a = std::make_shared<SmoothArguments>();
  c.add_option("input", a->input, "Mesh").type_name("FILE").required();
  add_mesh_output(c, a->output);
  add_schema(c, a->options);
  c.footer(
      "Vertices move, triangles stay as they are. Reported: how far, and the change of volume.\n\n"
      "Examples:\n"
      "  sansmesh smooth scan.ply -o smooth.ply\n"
      "  sansmesh smooth scan.ply -o smoother.ply --shorter-than 2.5\n"
      "  sansmesh smooth part.stl -o part.ply --creases");
  return {&c, [a](Console& console) { run_smooth(*a, console); }};
}

}  // namespace sansmesh::cli
