// Command `fill`: lists and fills the holes of a mesh.
#include "sansmesh/repair.h"

#include <fmt/core.h>

#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "cli/report/mesh_words.h"
#include "sansmesh/error.h"

namespace sansmesh::cli {
namespace {

constexpr std::size_t kMostLines = 30;

struct FillArguments {
  MeshInput input;
  MeshOutput output;
  FillOptions options;
  bool list = false;
};

void run_list(FillArguments& a, Console& console) {
  if (!a.output.file.empty()) throw ArgumentError("--list only lists holes: omit --output");
  const HolesResult found = list_holes(a.input.read(console), console.progress());
  console.note(a.input.file, found.notes);
  console.report(found);
  console.print(fmt::format("{}: {}", a.input.file, counted(found.triangles, "triangle")));
  console.print(summary_of(found.holes, found.holes.loops.size()));
}

void run_fill(FillArguments& a, Console& console) {
  a.options.validate();
  if (a.list) return run_list(a, console);
  if (a.output.file.empty()) throw ArgumentError("--output is required (or --list, which lists the holes)");
  a.output.check();
  const FillResult made = fill(a.input.read(console), a.options, console.progress());
  console.note(a.input.file, made.notes);
  warn_of_losses(a.input.file, a.input.report, a.output.file, made.mesh, console);
  a.output.write(made.mesh, console);
  console.report(made);
  if (!console.prints_text()) return;
  console.print(fmt::format("{} → {}: {}", a.input.file, a.output.file, counted(made.triangles, "triangle")));
  console.print(summary_of(made, kMostLines));
  if (made.report.found.loops.size() > kMostLines) console.print("(--list shows all holes)");
}

}  // namespace

Command add_fill(CommandLine& app) {
  CommandLine& c = app.add_subcommand("fill", "Mesh → mesh with holes filled, all or up to a size");
  auto a = std::make_shared<FillArguments>();
  a->input.add_to(c);
  add_mesh_output(c, a->output, false);
  c.add_flag("--list", a->list, "List the holes with positions and sizes, and write nothing");
  add_schema(c, a->options, {.without = {"share", "refine"}});
  c.footer(
      "A hole's diameter is the diagonal of its box. Colours and attributes of the fillings come from the border.\n\n"
      "Examples:\n"
      "  sansmesh fill scan.ply --list\n"
      "  sansmesh fill scan.ply -o closed.ply\n"
      "  sansmesh fill scan.ply -o patched.ply --largest 5");
  c.announce({report_of<HolesResult>(), report_of<FillResult>()});
  return {&c, [a](Console& console) { run_fill(*a, console); }};
}

}  // namespace sansmesh::cli
