// sansmesh edit: a function file in, a script of edits, a new function file out; its mesh brought up to date.
#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "commands.h"
#include "sansmesh/core/boxes.h"
#include "sansmesh/core/error.h"
#include "sansmesh/core/read_text.h"
#include "sansmesh/function/edit_function.h"
#include "sansmesh/function/edit_script.h"
#include "sansmesh/function/function_file.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/function/update_mesh.h"
#include "sansmesh/io/io.h"
#include "sansmesh/mesh/mesh_distance.h"

namespace sansmesh::cli {
namespace {

struct EditArguments {
  std::string input, script, output, mesh, mesh_output;
};

Json box_json(const Box3& box) {
  if (box.empty()) return nullptr;
  return {{box.lower.x, box.lower.y, box.lower.z}, {box.upper.x, box.upper.y, box.upper.z}};
}

Json boxes_json(const std::vector<Box3>& boxes) {
  Json json = Json::array();
  for (const Box3& box : boxes) json.push_back(box_json(box));
  return json;
}

/// Throws FileError unless it is a mesh of the function, whoever made it.
void check_mesh(const EditArguments& a, const SurfaceFunction& function, const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) throw FileError(a.mesh, "has no triangles");
  const MeshMatch match = match_mesh(function, mesh);
  if (match.belongs()) return;
  throw FileError(a.mesh,
                  fmt::format("is not a mesh of {}: {} of its {} vertices looked at {} on that surface, the "
                              "farthest is about {} off, at ({:.9g}, {:.9g}, {:.9g})",
                              a.input, grouped(match.on), grouped(match.vertices), match.on == 1 ? "lies" : "lie",
                              length(match.farthest), match.farthest_at.x, match.farthest_at.y, match.farthest_at.z));
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

void run_edit(const EditArguments& a, Console& console) {
  if (a.output.empty() && a.mesh_output.empty())
    throw ArgumentError("nothing to write: give -o FUNCTION, --mesh-output MESH or both");
  if (!a.output.empty()) check_function_writable(a.output);
  if (a.output == a.script) throw ArgumentError("the script would be overwritten: -o and --script name the same file");
  if (!a.mesh_output.empty()) check_writable(a.mesh_output, "mesh");
  if (!a.mesh.empty() && a.mesh_output.empty()) throw ArgumentError("--mesh needs --mesh-output");
  Progress& progress = console.progress();
  progress.begin("read");
  std::vector<Edit> edits;
  try {
    edits = parse_edit_script(read_text(a.script));
  } catch (const ArgumentError& error) {
    throw FileError(a.script, error.what());
  }
  FunctionEditor editor(read_function(a.input));
  TriangleMesh mesh;
  if (!a.mesh.empty()) {
    ReadReport read;
    mesh = to_mesh(read_points(a.mesh, &read));
    console.warn(a.mesh, read.warnings);
    check_mesh(a, editor.function(), mesh);
  }

  Json steps = Json::array();
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < edits.size(); ++i) {
    EditReport report;
    try {
      report = editor.apply(edits[i], progress);
    } catch (const ArgumentError& error) {
      throw FileError(a.script, fmt::format("step {}: {}", i + 1, error.what()));
    } catch (const DataError& error) {
      throw FileError(a.input, fmt::format("step {}: {}", i + 1, error.what()));
    }
    const std::size_t apart = separate_sets(report.regions);
    const Vec3 size = report.changed.empty() ? Vec3{} : report.changed.size();
    lines.push_back(fmt::format(
        "step {}: {}{}", i + 1, report.what,
        report.changed.empty() ? std::string()
                               : fmt::format(", {}within {} × {} × {}",
                                             apart > 1 ? fmt::format("in {} regions ", grouped(apart)) : std::string(),
                                             length(size.x), length(size.y), length(size.z))));
    steps.push_back({{"what", report.what},
                     {"selected", report.chosen},
                     {"supports", report.supports},
                     {"changed", box_json(report.changed)},
                     {"boxes", boxes_json(report.regions)}});
  }

  MeshUpdate update;
  if (!a.mesh_output.empty()) {
    try {
      mesh = a.mesh.empty() ? mesh_function(editor.function(), {}, progress)
                            : update_mesh(editor.function(), std::move(mesh), editor.changed(), {}, progress, &update);
    } catch (const DataError& error) {
      throw FileError(a.input, fmt::format("after the edits: {}", error.what()));
    }
  }
  progress.begin("write");
  Json json = {{"input", {{"file", a.input}}}, {"steps", steps}};
  if (!a.output.empty()) {
    write_function(a.output, editor.function());
    const PartitionReport& r = editor.function().field.report();
    lines.push_back(fmt::format("{}: {}", a.output, counted(r.functions, "local fit")));
    json["output"] = {{"file", a.output}, {"fits", r.functions}};
  }
  if (!a.mesh_output.empty()) {
    write_mesh(a.mesh_output, mesh);
    lines.push_back(fmt::format("{}: {}{}", a.mesh_output, counted(mesh.triangles.size(), "triangle"),
                                a.mesh.empty() ? std::string() : new_words(update, mesh.triangles.size())));
    json["mesh"] = {{"file", a.mesh_output},
                    {"triangles", mesh.triangles.size()},
                    {"local", update.local},
                    {"removed", update.removed},
                    {"added", update.added},
                    {"regions", update.regions},
                    {"why", update.why.empty() ? Json() : Json(update.why)}};
  }
  progress.finish();
  // Not before all has gone well: what fails has no results.
  for (const std::string& line : lines) console.say(line);
  console.say_json(json);
  console.print_timings();
}

}  // namespace

Command add_edit(CommandLine& app) {
  CommandLine& c =
      app.add_subcommand("edit", "Function file → function file, with parts fitted anew, smoothed or removed");
  auto a = std::make_shared<EditArguments>();
  c.add_option("input", a->input, "Function, .smf").type_name("FILE").required();
  c.add_option("--script", a->script, "What to do: JSON, see below").type_name("FILE").required();
  c.add_option("-o,--output", a->output, "Function to write: .smf").type_name("FILE");
  c.add_option(
       "--mesh", a->mesh,
       "The function's mesh before the edits, by `sansmesh mesh` without options: only what they change is made anew")
      .type_name("FILE");
  c.add_option("--mesh-output", a->mesh_output, "Mesh to write: .ply .obj .stl .off .glb .vtp").type_name("FILE");
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
