// sansmesh fill: holes of a mesh, listed and filled.
#include "sansmesh/repair.h"

#include <fmt/core.h>

#include <utility>

#include "commands.h"
#include "mesh_words.h"
#include "option_groups.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/mesh_measures.h"
#include "schema_options.h"

namespace sansmesh::cli {
namespace {

constexpr std::size_t kMostLines = 30;

struct FillArguments {
  std::string input;
  MeshOutput output;
  FillOptions options;
  bool list = false;
};

const char* outcome_word(FillReport::Outcome outcome) {
  switch (outcome) {
    case FillReport::Outcome::filled:
      return "filled";
    case FillReport::Outcome::too_large:
      return "left open";
    case FillReport::Outcome::failed:
      return "no way across";
    case FillReport::Outcome::end:
      return "steep, left open";
  }
  return "";
}

Json json_of_hole(const HoleLoop& loop, const char* outcome) {
  Json json = {{"edges", loop.vertices.size()}, {"diameter", loop.diameter},
               {"perimeter", loop.perimeter},   {"at", {loop.middle.x, loop.middle.y, loop.middle.z}},
               {"share_of_piece", loop.share},  {"steepness", loop.steepness}};
  if (*outcome) json["outcome"] = outcome;
  return json;
}

/// One line a hole, the largest first. `outcome` is empty where none was filled.
Json say_holes(const HoleLoops& found, const std::vector<FillReport::Outcome>& outcome, bool all, Console& console) {
  Json list = Json::array();
  for (std::size_t i = 0; i < found.loops.size(); ++i) {
    const HoleLoop& h = found.loops[i];
    const char* word = outcome.empty() ? "" : outcome_word(outcome[i]);
    list.push_back(json_of_hole(h, word));
    if (all || i < kMostLines)
      console.say(fmt::format(
          "{:>6} edges, diameter {:<9} ({:.0f} % of its piece), perimeter {:<9} at ({:.6g}, {:.6g}, {:.6g}){}{}",
          grouped(h.vertices.size()), length(h.diameter), 100 * h.share, length(h.perimeter), h.middle.x, h.middle.y,
          h.middle.z, *word ? ": " : "", word));
  }
  if (!all && found.loops.size() > kMostLines)
    console.say(fmt::format("and {} smaller ones (--list names them all)", grouped(found.loops.size() - kMostLines)));
  return list;
}

void say_title(const std::string& file, std::size_t triangles, const HoleLoops& found, Console& console) {
  console.say(fmt::format("{}: {}, {} with {}", file, counted(triangles, "triangle"),
                          counted(found.loops.size(), "hole"), counted(found.border_edges, "border edge")));
}

Json json_of_border(const std::string& file, std::size_t triangles, std::size_t joined, const HoleLoops& found) {
  return {{"input", {{"file", file}, {"triangles", triangles}, {"joined_vertices", joined}}},
          {"border_edges", found.border_edges},
          {"stray_border_edges", found.stray_edges},
          {"nonmanifold_edges", found.nonmanifold_edges}};
}

void run_list(const FillArguments& a, Console& console) {
  if (!a.output.file.empty()) throw ArgumentError("--list lists holes and writes nothing: leave out --output");
  console.progress().begin("read");
  ReadReport read;
  TriangleMesh mesh = read_mesh(a.input, &read);
  console.warn(a.input, read.warnings);
  const HolesResult found = list_holes(std::move(mesh), console.progress());
  console.progress().finish();
  console.note(a.input, found.notes);
  say_title(a.input, found.triangles, found.holes, console);
  Json json = json_of_border(a.input, found.triangles, found.joined_vertices, found.holes);
  json["holes"] = say_holes(found.holes, {}, true, console);
  console.say_json(json);
  console.print_timings();
}

void run_fill(const FillArguments& a, Console& console) {
  a.options.validate();
  if (a.list) return run_list(a, console);
  if (a.output.file.empty()) throw ArgumentError("--output is needed (or --list, which lists the holes)");
  a.output.check();
  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  TriangleMesh original = read_mesh(a.input, &read);
  console.warn(a.input, read.warnings);
  const FillResult made = fill(std::move(original), a.options, progress);
  const TriangleMesh& mesh = made.mesh;
  console.note(a.input, made.notes);
  console.warn(a.input, loss_words(read, a.output.file, mesh));
  a.output.write(mesh, progress);
  progress.finish();

  const FillReport& r = made.report;
  const MeshTopology t = measure_topology(mesh);
  say_title(a.input, made.triangles, r.found, console);
  Json json = json_of_border(a.input, made.triangles, made.joined_vertices, r.found);
  json["holes"] = say_holes(r.found, r.outcome, false, console);
  console.say(fmt::format("filled {}, left {} open; added {} and {} vertices, area {}", grouped(r.filled),
                          grouped(r.too_large + r.failed + r.ends), counted(r.triangles, "triangle"),
                          grouped(r.vertices), length(r.area)));
  console.say(fmt::format("{}: {}, {}", a.output.file, counted(mesh.triangles.size(), "triangle"), border_words(t)));
  json["filled"] = r.filled;
  json["left_open"] = r.too_large;
  json["ends"] = r.ends;
  json["failed"] = r.failed;
  json["islands"] = r.islands;
  json["added"] = {{"vertices", r.vertices}, {"triangles", r.triangles}, {"area", r.area}};
  json["output"] = output_json(a.output.file, mesh, t);
  console.say_json(json);
  console.print_timings();
}

}  // namespace

Command add_fill(CommandLine& app) {
  CommandLine& c = app.add_subcommand("fill", "Mesh → mesh whose holes are filled, all or up to a size");
  auto a = std::make_shared<FillArguments>();
  c.add_option("input", a->input, "Mesh").type_name("FILE").required();
  add_mesh_output(c, a->output, false);
  c.add_flag("--list", a->list, "List the holes with their places and sizes, and write nothing");
  add_schema(c, a->options, {.without = {"share", "refine"}});
  c.footer(
      "A hole's diameter is the diagonal of its box. Colours and attributes of the fillings come from the border.\n\n"
      "Examples:\n"
      "  sansmesh fill scan.ply --list\n"
      "  sansmesh fill scan.ply -o closed.ply\n"
      "  sansmesh fill scan.ply -o patched.ply --largest 5");
  return {&c, [a](Console& console) { run_fill(*a, console); }};
}

}  // namespace sansmesh::cli
