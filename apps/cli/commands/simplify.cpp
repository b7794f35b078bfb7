// Command `simplify`: reduces the number of triangles and reports the distance from the original.
#include "sansmesh/repair.h"

#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "cli/report/mesh_words.h"

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
  console.note(a.input.file, made.notes);
  warn_of_losses(a.input.file, a.input.report, a.output.file, made.mesh, console);
  a.output.write(made.mesh, console);
  console.report(made.report);
  if (!console.prints_text()) return;
  console.print(a.input.file + " → " + a.output.file);
  console.print(summary_of(made));
}

}  // namespace

Command add_simplify(CommandLine& app) {
  CommandLine& c =
      app.add_subcommand("simplify", "Mesh → mesh with fewer triangles, and its distance from the original");
  auto a = std::make_shared<SimplifyArguments>();
  a->input.add_to(c);
  add_mesh_output(c, a->output);
  add_schema(c, a->options);
  c.footer(
      "Borders, creases and topology are preserved; colours and attributes of merged vertices are averaged.\n\n"
      "Examples:\n"
      "  sansmesh simplify scan.ply -o small.ply --triangles 20000\n"
      "  sansmesh simplify scan.ply -o small.glb --error 0.05\n"
      "  sansmesh simplify scan.ply -o tenth.stl --ratio 0.1 --json");
  c.announce({report_of<SimplifyReport>()});
  return {&c, [a](Console& console) { run_simplify(*a, console); }};
}

}  // namespace sansmesh::cli
