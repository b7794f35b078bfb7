// sansmesh edit: a function file in, a script of edits, a new function file out; its mesh brought up to date.
#include "sansmesh/functions.h"

#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "commands.h"
#include "option_groups.h"
#include "sansmesh/core/boxes.h"
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

Json box_json(const Box3& box) {
  if (box.empty()) return nullptr;
  return {{box.lower.x, box.lower.y, box.lower.z}, {box.upper.x, box.upper.y, box.upper.z}};
}

Json step_json(const EditReport& r) {
  Json boxes = Json::array();
  for (const Box3& box : r.regions) boxes.push_back(box_json(box));
  return {{"what", r.what},
          {"selected", r.chosen},
          {"supports", r.supports},
          {"changed", box_json(r.changed)},
          {"boxes", boxes}};
}

/// The edit and its place, in words.
std::string step_words(const EditReport& r) {
  if (r.changed.empty()) return r.what;
  const std::size_t apart = separate_sets(r.regions);
  const Vec3 size = r.changed.size();
  return fmt::format("{}, {}within {} × {} × {}", r.what,
                     apart > 1 ? fmt::format("in {} regions ", grouped(apart)) : std::string(), length(size.x),
                     length(size.y), length(size.z));
}

/// What of the mesh is new: "162 of them new, 98.8 % kept", or why all of it is.
std::string new_words(const MeshUpdate& update, std::size_t triangles) {
  if (!update.local) return ", all made anew: " + update.why;
  if (update.regions == 0) return ", as they were";
  const double kept = 1 - static_cast<double>(update.added) / static_cast<double>(triangles);
  return fmt::format(", of which {} are new{}; {:.1f} % kept", grouped(update.added),
                     update.regions > 1 ? fmt::format(", in {} regions", grouped(update.regions)) : std::string(),
                     std::floor(1000 * kept) / 10);
}

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
  Progress& progress = console.progress();
  progress.begin("write");
  Json json = {{"input", {{"file", a.input}}}, {"steps", Json::array()}};
  for (const EditReport& step : made.steps) json["steps"].push_back(step_json(step));
  const std::size_t fits = info(made.function).fits, triangles = made.mesh.triangles.size();
  const MeshUpdate& update = made.update;
  if (!a.output.empty()) {
    write_function(a.output, made.function);
    json["output"] = {{"file", a.output}, {"fits", fits}};
  }
  if (!a.mesh_output.empty()) {
    write_mesh(a.mesh_output, made.mesh);
    json["mesh"] = {{"file", a.mesh_output},
                    {"triangles", triangles},
                    {"local", update.local},
                    {"removed", update.removed},
                    {"added", update.added},
                    {"regions", update.regions},
                    {"why", update.why.empty() ? Json() : Json(update.why)}};
  }
  progress.finish();
  for (std::size_t i = 0; i < made.steps.size(); ++i)
    console.say(fmt::format("step {}: {}", i + 1, step_words(made.steps[i])));
  if (!a.output.empty()) console.say(fmt::format("{}: {}", a.output, counted(fits, "local fit")));
  if (!a.mesh_output.empty())
    console.say(fmt::format("{}: {}{}", a.mesh_output, counted(triangles, "triangle"),
                            a.mesh.empty() ? std::string() : new_words(update, triangles)));
  console.say_json(json);
  console.print_timings();
}

}  // namespace

Command add_edit(CommandLine& app) {
  CommandLine& c =
      app.add_subcommand("edit", "Function file → function file, with parts fitted anew, smoothed or removed");
  auto a = std::make_shared<EditArguments>();
  c.add_option("input", a->input, "Function, .smf").type_name("FILE").endings({".smf"}).required();
  c.add_option("--script", a->script, "What to do: JSON, see below").type_name("FILE").required();
  c.add_option("-o,--output", a->output, "Function to write: .smf").type_name("FILE");
  c.add_option(
       "--mesh", a->mesh,
       "The function's mesh before the edits, by `sansmesh mesh` without options: only what they change is made anew")
      .type_name("FILE");
  c.add_option("--mesh-output", a->mesh_output, "Mesh to write: " + listed_endings(endings_written(kMesh)))
      .type_name("FILE");
  c.footer(
      "A script is {\"version\": 1, \"steps\": [...]}; a step selects supports and says what to do with them:\n"
      "  {\"select\": {\"ball\": {\"center\": [0, 0, 1], \"radius\": 0.2}}, \"degree\": 1}\n"
      "  {\"select\": {\"error_above\": 0.01}, \"refit\": {\"error\": 0.001, \"max_degree\": 4, \"sharp\": false}}\n"
      "  {\"select\": {\"sheets\": \"spurious\"}, \"remove\": true}\n"
      "  {\"select\": {\"sheet_at\": [1, 2, 3]}, \"constant\": \"outside\"}\n"
      "  {\"undo\": 1}\n"
      "Further selections: box, half_space, coverage_below, samples_below, level_from, level_to; all conditions "
      "must\n"
      "hold, {} is everything. `sansmesh diagnose` writes such scripts.\n\n"
      "Examples:\n"
      "  sansmesh edit scan.smf --script edits.json -o new.smf\n"
      "  sansmesh edit scan.smf --script edits.json -o new.smf --mesh scan.ply --mesh-output new.ply");
  return {&c, [a](Console& console) { run_edit(*a, console); }};
}

}  // namespace sansmesh::cli
