// sansmesh simplify: fewer triangles for the same surface, and how far off these are.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "commands.h"
#include "mesh_words.h"
#include "option_groups.h"
#include "sansmesh/core/error.h"
#include "sansmesh/io/io.h"
#include "sansmesh/mesh/components.h"
#include "sansmesh/mesh/mesh_distance.h"
#include "sansmesh/mesh/mesh_topology.h"
#include "sansmesh/mesh/place_edges.h"
#include "sansmesh/mesh/simplify.h"

namespace sansmesh::cli {
namespace {

/// What is asked for where only a number of triangles is: errors grow from this part of the diagonal.
constexpr double kFirstError = 1e-5;
constexpr double kUsualRatio = 0.5;
/// Of the diagonal: who is farther off is told so.
constexpr double kMuch = 0.01;
/// Shapes of the triangles made, best first: worse ones only if a number of triangles wants them.
constexpr double kShapes[] = {0.3, 0.1, 0};

struct SimplifyArguments {
  std::string input;
  MeshOutput output;
  std::optional<std::size_t> triangles;
  std::optional<double> ratio, error;
  std::optional<double> shape;
};

Json json_of_distance(const OneWayDistance& d) {
  return {{"mean", d.mean}, {"rms", d.rms}, {"p95", d.p95}, {"max", d.max}};
}

void run_simplify(const SimplifyArguments& a, Console& console) {
  if ((a.triangles ? 1 : 0) + (a.ratio ? 1 : 0) + (a.error ? 1 : 0) > 1)
    throw ArgumentError("--triangles, --ratio and --error each say how far to go: give one of them");
  if (a.ratio && !(*a.ratio > 0 && *a.ratio < 1)) throw ArgumentError("--ratio must lie between 0 and 1");
  if (a.error && !(*a.error > 0 && std::isfinite(*a.error))) throw ArgumentError("--error must be positive");
  if (a.shape && !(*a.shape >= 0 && *a.shape <= 0.9)) throw ArgumentError("--shape must lie in 0..0.9");
  a.output.check();
  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  TriangleMesh mesh = read_mesh(a.input, &read);
  std::vector<std::string> warnings = read.warnings;
  const TriangleMesh original = mesh;
  const JoinedPlaces places = join_places(mesh);
  if (places.seams > 0)
    warnings.push_back(
        fmt::format("{} at the same place as another, but with other colours or attributes: seams may open",
                    places.seams == 1 ? "1 vertex is" : grouped(places.seams) + " vertices are"));
  std::erase_if(mesh.triangles, [&](const Triangle& t) { return !is_whole(mesh, t); });
  keep_triangles(mesh, std::vector<std::uint8_t>(mesh.triangles.size(), 1));  // and none of the vertices beside them
  SimplifyOptions options;
  const double diagonal = bounds(mesh).diagonal();
  options.error = a.error.value_or(kFirstError * diagonal);
  if (!a.error)
    options.triangles = a.triangles.value_or(static_cast<std::size_t>(
        std::max(4.0, std::round(a.ratio.value_or(kUsualRatio) * static_cast<double>(original.triangles.size())))));
  progress.begin("simplify");
  for (const double shape : kShapes) {
    options.least_shape = a.shape.value_or(shape);
    if (options.error > 0) simplify_mesh(mesh, options, progress);
    if (a.shape || a.error || mesh.triangles.size() <= options.triangles) break;
  }
  const MeshTopology t = measure_topology(mesh);
  if (options.triangles > 0 && mesh.triangles.size() > options.triangles)
    warnings.push_back(fmt::format("{} instead of the {} triangles asked for: no other edge can go{}",
                                   grouped(mesh.triangles.size()), grouped(options.triangles),
                                   t.nonmanifold_edges > 0 ? fmt::format(" ({} of three triangles or more stay)",
                                                                         counted(t.nonmanifold_edges, "edge"))
                                                           : ", or the shape would change"));
  DistanceOptions sampling;
  const SurfaceDistance d = measure_distance(mesh, original, sampling, progress);
  const double farthest = std::max(d.to_reference.max, d.from_reference.max);
  if (d.diagonal > 0 && farthest > kMuch * d.diagonal)
    warnings.push_back(fmt::format(
        "up to {} off, {:.1f} % of the diagonal (rms {:.2f} %): {} are too few for all of its shape{}",
        length(farthest), 100 * farthest / d.diagonal,
        100 * std::max(d.to_reference.rms, d.from_reference.rms) / d.diagonal,
        counted(mesh.triangles.size(), "triangle"), a.error ? "" : "; --error says how far off they may be"));
  for (std::string& line : loss_words(read, a.output.file, mesh)) warnings.push_back(std::move(line));
  console.warn(a.input, warnings);
  a.output.write(mesh, progress);
  progress.finish();

  console.say(fmt::format("{}: {}, {} vertices", a.input, counted(original.triangles.size(), "triangle"),
                          grouped(original.vertices.size())));
  const auto line = [&](const char* title, const OneWayDistance& one) {
    const auto percent = [&](double x) { return fmt::format("{} ({:.4f} %)", length(x), d.percent(x)); };
    console.say(
        fmt::format("{:<16}mean {}, rms {}, max {}", title, percent(one.mean), percent(one.rms), percent(one.max)));
  };
  console.say(fmt::format("{}: {} ({:.2f} %), {} vertices, {}", a.output.file,
                          counted(mesh.triangles.size(), "triangle"),
                          100.0 * static_cast<double>(mesh.triangles.size()) /
                              static_cast<double>(std::max<std::size_t>(original.triangles.size(), 1)),
                          grouped(mesh.vertices.size()), border_words(t)));
  line("to original", d.to_reference);
  line("from original", d.from_reference);
  console.say("(in brackets: % of the diagonal of the original's bounding box)");
  console.say_json(
      {{"input", {{"file", a.input}, {"vertices", original.vertices.size()}, {"triangles", original.triangles.size()}}},
       {"joined_vertices", places.joined},
       {"to_original", json_of_distance(d.to_reference)},
       {"from_original", json_of_distance(d.from_reference)},
       {"diagonal", d.diagonal},
       {"output", output_json(a.output.file, mesh, t)}});
  console.print_timings();
}

}  // namespace

Command add_simplify(CommandLine& app) {
  CommandLine& c = app.add_subcommand("simplify", "Mesh → mesh of fewer triangles, and how far it is off");
  auto a = std::make_shared<SimplifyArguments>();
  c.add_option("input", a->input, "Mesh").type_name("FILE").required();
  add_mesh_output(c, a->output);
  c.add_option("--triangles", a->triangles, "Down to so many triangles").type_name("COUNT").within(4, 2000000000);
  c.add_option("--ratio", a->ratio, "Down to this share of the triangles [0.5]").type_name("SHARE");
  c.add_option("--error", a->error, "As few triangles as this distance from the original allows (rms, at each vertex)")
      .type_name("LENGTH");
  c.add_option("--shape", a->shape,
               "Worst shape of the triangles made: 0 any, 0.3 angles of 10°, 0.56 of 20° [0.3; less if it must be]")
      .type_name("SHARE");
  c.footer(
      "Borders, creases and topology stay; colours and attributes of vertices that merge are averaged.\n\n"
      "Examples:\n"
      "  sansmesh simplify scan.ply -o small.ply --triangles 20000\n"
      "  sansmesh simplify scan.ply -o small.glb --error 0.05\n"
      "  sansmesh simplify scan.ply -o tenth.stl --ratio 0.1 --json");
  return {&c, [a](Console& console) { run_simplify(*a, console); }};
}

}  // namespace sansmesh::cli
