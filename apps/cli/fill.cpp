// sansmesh fill: holes of a mesh, listed and filled.
#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "commands.h"
#include "mesh_words.h"
#include "option_groups.h"
#include "sansmesh/core/error.h"
#include "sansmesh/io/io.h"
#include "sansmesh/mesh/fill_holes.h"
#include "sansmesh/mesh/mesh_topology.h"
#include "sansmesh/mesh/place_edges.h"

namespace sansmesh::cli {
namespace {

constexpr std::size_t kMostLines = 30;
constexpr double kWideShare = 0.1;

struct FillArguments {
  std::string input;
  MeshOutput output;
  FillOptions options;
  bool list = false, flat = false;
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

/// Holes so wide that it should be said that they were filled by default.
std::size_t wide_caps(const FillReport& r) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < r.outcome.size(); ++i)
    count += r.outcome[i] == FillReport::Outcome::filled && r.found.loops[i].share > kWideShare;
  return count;
}

std::string irregular(const HoleLoops& found) {
  if (found.stray_edges == 0) return "";
  return fmt::format("{} of the border run to edges of three triangles or more, and around no hole: they stay open",
                     counted(found.stray_edges, "edge"));
}

void run_fill(FillArguments& a, Console& console) {
  a.options.fair = !a.flat;
  a.options.validate();
  if (a.list) {
    if (!a.output.file.empty()) throw ArgumentError("--list lists holes and writes nothing: leave out --output");
  } else {
    if (a.output.file.empty()) throw ArgumentError("--output is needed (or --list, which lists the holes)");
    a.output.check();
  }
  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  TriangleMesh mesh = read_mesh(a.input, &read);
  std::vector<std::string> warnings = read.warnings;
  const JoinedPlaces places = join_places(mesh);
  const std::size_t triangles = mesh.triangles.size();
  Json json = {{"input", {{"file", a.input}, {"triangles", triangles}, {"joined_vertices", places.joined}}}};
  const auto title = [&](const HoleLoops& found) {
    console.say(fmt::format("{}: {}, {} with {}", a.input, counted(triangles, "triangle"),
                            counted(found.loops.size(), "hole"), counted(found.border_edges, "border edge")));
  };
  const auto describe = [&](const HoleLoops& found) {
    json["border_edges"] = found.border_edges;
    json["stray_border_edges"] = found.stray_edges;
    json["nonmanifold_edges"] = found.nonmanifold_edges;
    if (const std::string line = irregular(found); !line.empty()) warnings.push_back(line);
  };
  if (a.list) {
    progress.begin("find holes");
    const HoleLoops found = find_holes(mesh);
    describe(found);
    progress.finish();
    console.warn(a.input, warnings);
    title(found);
    json["holes"] = say_holes(found, {}, true, console);
    console.say_json(json);
    console.print_timings();
    return;
  }
  const FillReport r = fill_holes(mesh, a.options, progress);
  describe(r.found);
  if (r.failed > 0)
    warnings.push_back(
        fmt::format("{} cannot be filled without an edge that is there already", counted(r.failed, "hole")));
  if (r.ends > 0) {
    double widest = 0;
    for (std::size_t i = 0; i < r.outcome.size(); ++i)
      if (r.outcome[i] == FillReport::Outcome::end) widest = std::max(widest, r.found.loops[i].diameter);
    warnings.push_back(
        fmt::format("{} open: the surface runs into {} steeply, as at the end of a tube; "
                    "--largest {} closes {}, --all everything",
                    r.ends == 1 ? "1 opening stays" : grouped(r.ends) + " openings stay", r.ends == 1 ? "it" : "them",
                    length(widest * 1.01), r.ends == 1 ? "it" : "them"));
  }
  if (const std::size_t caps = wide_caps(r); caps > 0)
    warnings.push_back(
        fmt::format("{} wider than a tenth of the piece around: what lies across is invented",
                    caps == 1 ? "1 hole that was filled is" : grouped(caps) + " holes that were filled are"));
  if (r.islands > 0)
    warnings.push_back(
        fmt::format("{} lie in or near what was filled, and stay there", counted(r.islands, "separate piece")));
  if (places.seams > 0)
    warnings.push_back(
        fmt::format("{} at the same place as another, with other colours or attributes: seams, but no holes",
                    places.seams == 1 ? "1 vertex is" : grouped(places.seams) + " vertices are"));
  for (std::string& line : loss_words(read, a.output.file, mesh)) warnings.push_back(std::move(line));
  console.warn(a.input, warnings);
  a.output.write(mesh, progress);
  progress.finish();

  const MeshTopology t = measure_topology(mesh);
  title(r.found);
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
  FillOptions& o = a->options;
  c.add_option("input", a->input, "Mesh").type_name("FILE").required();
  add_mesh_output(c, a->output, false);
  c.add_flag("--list", a->list, "List the holes with their places and sizes, and write nothing");
  c.add_option(
       "--largest", o.largest,
       "Fill holes of at most this diameter [a fifth of the diagonal of the piece that they are in, and no ends: "
       "openings that the surface runs into steeply]")
      .type_name("LENGTH");
  c.add_option("--edges", o.edges, "Fill holes of at most so many edges").type_name("COUNT").within(3, 2000000000);
  c.add_flag("--all", o.all, "Fill all, outer borders of open surfaces too");
  c.add_flag("--flat", a->flat, "Fill with the smallest surface instead of one that goes on smoothly");
  c.footer(
      "A hole's diameter is the diagonal of its box. Colours and attributes of the fillings come from the border.\n\n"
      "Examples:\n"
      "  sansmesh fill scan.ply --list\n"
      "  sansmesh fill scan.ply -o closed.ply\n"
      "  sansmesh fill scan.ply -o patched.ply --largest 5");
  return {&c, [a](Console& console) { run_fill(*a, console); }};
}

}  // namespace sansmesh::cli
