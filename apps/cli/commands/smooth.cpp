// Command `smooth`: removes noise from a mesh.
#include "sansmesh/repair.h"

#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "cli/report/mesh_words.h"

namespace sansmesh::cli {
namespace {

struct SmoothArguments {
  MeshInput input;
  MeshOutput output;
  SmoothOptions options;
};

void run_smooth(SmoothArguments& a, Console& console) {
  a.options.validate();
  a.output.check();
  const SmoothResult made = smooth(a.input.read(console), a.options, console.progress());
  console.note(a.input.file, made.notes);
  warn_of_losses(a.input.file, a.input.report, a.output.file, made.mesh, console);
  a.output.write(made.mesh, console);
  console.report(made.report);
  console.print(a.input.file + " → " + a.output.file + ": " + counted(made.mesh.triangles.size(), "triangle"));
  console.print(summary_of(made.report));
}

}  // namespace

Command add_smooth(CommandLine& app) {
  CommandLine& c = app.add_subcommand("smooth", "Mesh → mesh without noise, preserving its volume or its creases");
  auto a = std::make_shared<SmoothArguments>();
  a->input.add_to(c);
  add_mesh_output(c, a->output);
  add_schema(c, a->options);
  c.footer(
      "Vertices move, triangles stay the same. The report has distances and the change of volume.\n\n"
      "Examples:\n"
      "  sansmesh smooth scan.ply -o smooth.ply\n"
      "  sansmesh smooth scan.ply -o smoother.ply --shorter-than 2.5\n"
      "  sansmesh smooth part.stl -o part.ply --creases");
  c.announce({report_of<SmoothReport>()});
  return {&c, [a](Console& console) { run_smooth(*a, console); }};
}

}  // namespace sansmesh::cli
