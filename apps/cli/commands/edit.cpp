// Command `edit`: applies a script of edits to a function file and updates its mesh.
#include "sansmesh/functions.h"

#include <fmt/core.h>

#include <utility>

#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/report/mesh_words.h"
#include "sansmesh/core/read_text.h"
#include "sansmesh/error.h"
#include "sansmesh/function_edits.h"
#include "sansmesh/io.h"
#include "sansmesh/io/formats.h"

namespace sansmesh::cli {
namespace {

struct EditArguments {
  std::string input, script, output, mesh, mesh_output;
};

void check_files(const EditArguments& a) {
  require(!a.output.empty() || !a.mesh_output.empty(),
          "nothing to write: give -o FUNCTION, --mesh-output MESH or both");
  if (!a.output.empty()) check_function_writable(a.output);
  require(a.output != a.script, "the script would be overwritten: -o and --script name the same file");
  if (!a.mesh_output.empty()) check_writable(a.mesh_output, "mesh");
  require(a.mesh.empty() || !a.mesh_output.empty(), "--mesh needs --mesh-output");
}

EditedFunction edited(const EditArguments& a, Console& console) {
  console.progress().begin("read");
  try {
    const std::vector<Edit> edits = parse_edit_script(read_text(a.script));
    EditInput input{.function = read_function(a.input), .name = a.input, .mesh_name = a.mesh};
    if (!a.mesh.empty()) {
      ReadReport read;
      input.mesh = to_mesh(read_points(a.mesh, &read));
      console.warn(a.mesh, read.warnings);
    }
    return edit(std::move(input), edits, !a.mesh_output.empty(), console.progress());
  } catch (const ArgumentError& error) {
    throw FileError(a.script, error.what());
  }
}

void run_edit(const EditArguments& a, Console& console) {
  check_files(a);
  const EditedFunction made = edited(a, console);
  console.progress().begin("write");
  if (!a.output.empty()) write_function(a.output, made.function);
  if (!a.mesh_output.empty()) write_mesh(a.mesh_output, made.mesh);
  console.report(FileReport{a.input}, "input");
  console.report(made);
  if (!a.output.empty()) console.report(FileReport{a.output}, "output");
  if (!a.mesh_output.empty()) report_mesh(a.mesh_output, made.mesh, console, "mesh");

  for (std::size_t i = 0; i < made.steps.size(); ++i)
    console.print(fmt::format("step {}: {}", i + 1, words_of(made.steps[i])));
  if (!a.output.empty()) console.print(fmt::format("{}: {}", a.output, counted(info(made.function).fits, "local fit")));
  const std::size_t triangles = made.mesh.triangles.size();
  if (!a.mesh_output.empty())
    console.print(fmt::format("{}: {}{}", a.mesh_output, counted(triangles, "triangle"),
                              a.mesh.empty() ? std::string() : words_of(made.update, triangles)));
}

}  // namespace

Command add_edit(CommandLine& app) {
  CommandLine& c =
      app.add_subcommand("edit", "Function file → function file, with parts refitted, smoothed or removed");
  auto a = std::make_shared<EditArguments>();
  add_function_input(c, a->input);
  c.add_option("--script", a->script, "Edits as JSON, see below").reads({".json"}).required();
  c.add_option("-o,--output", a->output, "Function to write: .smf").writes({".smf"});
  c.add_option(
       "--mesh", a->mesh,
       "Mesh of the function before the edits, by `sansmesh mesh` without options: only changed parts are meshed again")
      .reads(endings_read(kPoints));
  c.add_option("--mesh-output", a->mesh_output, "Mesh to write: " + listed_endings(endings_written(kMesh)))
      .writes(endings_written(kMesh));
  c.footer(
      "A script is {\"version\": 1, \"steps\": [...]}; a step selects supports and an action:\n"
      "  {\"select\": {\"ball\": {\"center\": [0, 0, 1], \"radius\": 0.2}}, \"degree\": 1}\n"
      "  {\"select\": {\"error_above\": 0.01}, \"refit\": {\"error\": 0.001, \"max_degree\": 4, \"sharp\": false}}\n"
      "  {\"select\": {\"sheets\": \"spurious\"}, \"remove\": true}\n"
      "  {\"select\": {\"sheet_at\": [1, 2, 3]}, \"constant\": \"outside\"}\n"
      "  {\"undo\": 1}\n"
      "Further selections: box, half_space, coverage_below, samples_below, level_from, level_to; all conditions "
      "must\n"
      "hold, {} selects everything. `sansmesh diagnose` writes such scripts.\n\n"
      "Examples:\n"
      "  sansmesh edit scan.smf --script edits.json -o new.smf\n"
      "  sansmesh edit scan.smf --script edits.json -o new.smf --mesh scan.ply --mesh-output new.ply");
  c.announce({report_of<FileReport>("input"), report_of<EditedFunction>(), report_of<FileReport>("output"),
              report_of<WrittenMesh>("mesh")});
  return {&c, [a](Console& console) { run_edit(*a, console); }};
}

}  // namespace sansmesh::cli
