// sansmesh simplify: fewer triangles for the same surface, and how far off these are.
#include "sansmesh/repair.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "commands.h"
#include "mesh_words.h"
#include "option_groups.h"
#include "sansmesh/io.h"
#include "sansmesh/mesh_measures.h"
#include "schema_options.h"

namespace sansmesh::cli {
namespace {

struct SimplifyArguments {
  std::string input;
  MeshOutput output;
  SimplifyOptions options;
};

Json json_of_distance(const OneWayDistance& d) {
  return {{"mean", d.mean}, {"rms", d.rms}, {"p95", d.p95}, {"max", d.max}};
}

void report_simplified(const SimplifyArguments& a, const SimplifyResult& made, Console& console) {
  const SimplifyReport& r = made.report;
  console.say(fmt::format("{}: {}, {} vertices", a.input, counted(r.triangles, "triangle"), grouped(r.vertices)));
  const TriangleMesh& mesh = made.mesh;
  const MeshTopology t = measure_topology(mesh);
  const auto line = [&](const char* title, const OneWayDistance& one) {
    const auto percent = [&](double x) { return fmt::format("{} ({:.4f} %)", length(x), r.distance.percent(x)); };
    console.say(
        fmt::format("{:<16}mean {}, rms {}, max {}", title, percent(one.mean), percent(one.rms), percent(one.max)));
  };
  console.say(fmt::format(
      "{}: {} ({:.2f} %), {} vertices, {}", a.output.file, counted(mesh.triangles.size(), "triangle"),
      100.0 * static_cast<double>(mesh.triangles.size()) / static_cast<double>(std::max<std::size_t>(r.triangles, 1)),
      grouped(mesh.vertices.size()), border_words(t)));
  line("to original", r.distance.to_reference);
  line("from original", r.distance.from_reference);
  console.say("(in brackets: % of the diagonal of the original's bounding box)");
  if (r.farthest_by_shape)
    console.say(fmt::format("worse triangles than usual: as good ones as can be would be up to {} off",
                            length(*r.farthest_by_shape)));
  console.say_json({{"input", {{"file", a.input}, {"vertices", r.vertices}, {"triangles", r.triangles}}},
                    {"joined_vertices", r.joined_vertices},
                    {"to_original", json_of_distance(r.distance.to_reference)},
                    {"from_original", json_of_distance(r.distance.from_reference)},
                    {"diagonal", r.distance.diagonal},
                    {"least_shape", r.least_shape},
                    {"output", output_json(a.output.file, mesh, t)}});
  console.print_timings();
}

void run_simplify(const SimplifyArguments& a, Console& console) {
  a.options.validate();
  a.output.check();
  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  TriangleMesh mesh = read_mesh(a.input, &read);
  console.warn(a.input, read.warnings);
  const SimplifyResult made = simplify(std::move(mesh), a.options, progress);
  console.note(a.input, made.notes);
  console.warn(a.input, loss_words(read, a.output.file, made.mesh));
  a.output.write(made.mesh, progress);
  progress.finish();

  report_simplified(a, made, console);
}

}  // namespace

Command add_simplify(CommandLine& app) {
  CommandLine& c = app.add_subcommand("simplify", "Mesh → mesh of fewer triangles, and how far it is off");
  auto a = std::make_shared<SimplifyArguments>();
  c.add_option("input", a->input, "Mesh").type_name("FILE").required();
  add_mesh_output(c, a->output);
  add_schema(c, a->options);
  c.footer(
      "Borders, creases and topology stay; colours and attributes of vertices that merge are averaged.\n\n"
      "Examples:\n"
      "  sansmesh simplify scan.ply -o small.ply --triangles 20000\n"
      "  sansmesh simplify scan.ply -o small.glb --error 0.05\n"
      "  sansmesh simplify scan.ply -o tenth.stl --ratio 0.1 --json");
  return {&c, [a](Console& console) { run_simplify(*a, console); }};
}

}  // namespace sansmesh::cli
