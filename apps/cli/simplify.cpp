// sansmesh simplify: fewer triangles for the same surface, and how far off these are.
#include "sansmesh/repair.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "commands.h"
#include "mesh_words.h"
#include "option_groups.h"
#include "sansmesh/mesh/mesh_distance.h"
#include "sansmesh/mesh_measures.h"
#include "schema_options.h"

namespace sansmesh::cli {
namespace {

struct SimplifyArguments {
  MeshInput input;
  MeshOutput output;
  SimplifyOptions options;
};

void run_simplify(SimplifyArguments& a, Console& console) {
  a.options.validate();
  a.output.check();
  const SimplifyResult made = simplify(a.input.read(console), a.options, console.progress());
  const SimplifyReport& r = made.report;
  const TriangleMesh& mesh = made.mesh;
  console.note(a.input.file, made.notes);
  warn_of_losses(a.input.file, a.input.report, a.output.file, mesh, console);
  a.output.write(mesh, console);
  console.tell(r);

  console.say(fmt::format("{}: {}, {} vertices", a.input.file, counted(r.triangles, "triangle"), grouped(r.vertices)));
  console.say(fmt::format(
      "{}: {} ({:.2f} %), {} vertices, {}", a.output.file, counted(mesh.triangles.size(), "triangle"),
      100.0 * static_cast<double>(mesh.triangles.size()) / static_cast<double>(std::max<std::size_t>(r.triangles, 1)),
      grouped(mesh.vertices.size()), border_words(measure_topology(mesh))));
  console.say("to original", distance_words(r.distance.to_reference, r.distance));
  console.say("from original", distance_words(r.distance.from_reference, r.distance));
  console.say("(in brackets: % of the diagonal of the original's bounding box)");
  if (r.farthest_by_shape)
    console.say(fmt::format("worse triangles than usual: as good ones as can be would be up to {} off",
                            length(*r.farthest_by_shape)));
}

}  // namespace

Command add_simplify(CommandLine& app) {
  CommandLine& c = app.add_subcommand("simplify", "Mesh → mesh of fewer triangles, and how far it is off");
  auto a = std::make_shared<SimplifyArguments>();
  a->input.add_to(c);
  add_mesh_output(c, a->output);
  add_schema(c, a->options);
  c.footer(
      "Borders, creases and topology stay; colours and attributes of vertices that merge are averaged.\n\n"
      "Examples:\n"
      "  sansmesh simplify scan.ply -o small.ply --triangles 20000\n"
      "  sansmesh simplify scan.ply -o small.glb --error 0.05\n"
      "  sansmesh simplify scan.ply -o tenth.stl --ratio 0.1 --json");
  c.tells({told<SimplifyReport>()});
  return {&c, [a](Console& console) { run_simplify(*a, console); }};
}

}  // namespace sansmesh::cli
