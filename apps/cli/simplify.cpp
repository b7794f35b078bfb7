// sansmesh simplify: fewer triangles for the same surface, and how far off these are.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "commands.h"
#include "mesh_words.h"
#include "option_groups.h"
#include "sansmesh/core/error.h"
#include "sansmesh/core/index_in.h"
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
/// Shapes of the triangles made, best first: worse ones only if a number of triangles wants them, or where so few of
/// better ones are far off and worse ones are not, or have no more than this share of the distance.
constexpr double kShapes[] = {0.3, 0.1, 0};
constexpr double kWorthIt = 0.7;

struct SimplifyArguments {
  std::string input;
  MeshOutput output;
  std::optional<std::size_t> triangles;
  std::optional<double> ratio, error;
  std::optional<double> shape;
};

/// A mesh made of the original, and how far they are from each other.
struct Simplified {
  TriangleMesh mesh;
  SurfaceDistance distance;
  double shape = 0;  ///< least one of the triangles made

  double farthest() const { return std::max(distance.to_reference.max, distance.from_reference.max); }
  double rms() const { return std::max(distance.to_reference.rms, distance.from_reference.rms); }
  bool far_off() const { return distance.diagonal > 0 && farthest() > kMuch * distance.diagonal; }
};

/// From the shape with this index in kShapes on, or that which was asked for.
Simplified simplify_from(std::size_t first_shape, TriangleMesh mesh, const TriangleMesh& original,
                         const SimplifyArguments& a, SimplifyOptions options, Progress& progress) {
  progress.begin("simplify");
  for (std::size_t k = first_shape; k < std::size(kShapes); ++k) {
    options.least_shape = a.shape.value_or(kShapes[k]);
    if (options.error > 0) simplify_mesh(mesh, options, progress);
    if (a.shape || a.error || mesh.triangles.size() <= options.triangles) break;
  }
  Simplified made{std::move(mesh), {}, options.least_shape};
  made.distance = measure_distance(made.mesh, original, DistanceOptions{}, progress);
  return made;
}

Json json_of_distance(const OneWayDistance& d) {
  return {{"mean", d.mean}, {"rms", d.rms}, {"p95", d.p95}, {"max", d.max}};
}

std::string far_off_words(const SimplifyArguments& a, const Simplified& made) {
  const char* remedy = "; --error says how far off they may be";
  if (a.error) remedy = "";
  if (a.shape.value_or(0) > 0) remedy = "; --shape 0 makes thinner ones, which may come nearer";
  const SurfaceDistance& d = made.distance;
  return fmt::format("up to {} off, {:.1f} % of the diagonal (rms {:.2f} %): {} {} too few for all of its shape{}",
                     length(made.farthest()), d.percent(made.farthest()), d.percent(made.rms()),
                     counted(made.mesh.triangles.size(), "triangle"), made.mesh.triangles.size() == 1 ? "is" : "are",
                     remedy);
}

/// `first_farthest`: how far off the best shapes were.
void report_simplified(const SimplifyArguments& a, const TriangleMesh& original, const JoinedPlaces& places,
                       const Simplified& best, double first_farthest, Console& console) {
  console.say(fmt::format("{}: {}, {} vertices", a.input, counted(original.triangles.size(), "triangle"),
                          grouped(original.vertices.size())));
  const SurfaceDistance& d = best.distance;
  const TriangleMesh& mesh = best.mesh;
  const MeshTopology t = measure_topology(mesh);
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
  if (best.farthest() < first_farthest)
    console.say(fmt::format("worse triangles than usual: as good ones as can be would be up to {} off",
                            length(first_farthest)));
  console.say_json(
      {{"input", {{"file", a.input}, {"vertices", original.vertices.size()}, {"triangles", original.triangles.size()}}},
       {"joined_vertices", places.joined},
       {"to_original", json_of_distance(d.to_reference)},
       {"from_original", json_of_distance(d.from_reference)},
       {"diagonal", d.diagonal},
       {"least_shape", best.shape},
       {"output", output_json(a.output.file, mesh, t)}});
  console.print_timings();
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
    options.triangles = a.triangles.value_or(index_in<std::size_t>(
        std::round(a.ratio.value_or(kUsualRatio) * static_cast<double>(original.triangles.size())), 4,
        std::max<std::size_t>(4, original.triangles.size())));
  Simplified best = simplify_from(0, mesh, original, a, options, progress);
  const double first_farthest = best.farthest();
  for (std::size_t k = 1; k < std::size(kShapes) && best.far_off() && !a.shape && !a.error; ++k) {
    Simplified other = simplify_from(k, mesh, original, a, options, progress);
    if (other.farthest() < kWorthIt * best.farthest()) best = std::move(other);
  }
  const MeshTopology t = measure_topology(best.mesh);
  if (options.triangles > 0 && best.mesh.triangles.size() > options.triangles)
    warnings.push_back(fmt::format("{} instead of the {} triangles asked for: no other edge can go{}",
                                   grouped(best.mesh.triangles.size()), grouped(options.triangles),
                                   t.nonmanifold_edges > 0 ? fmt::format(" ({} of three triangles or more stay)",
                                                                         counted(t.nonmanifold_edges, "edge"))
                                                           : ", or the shape would change"));
  if (best.far_off()) warnings.push_back(far_off_words(a, best));
  for (std::string& line : loss_words(read, a.output.file, best.mesh)) warnings.push_back(std::move(line));
  console.warn(a.input, warnings);
  a.output.write(best.mesh, progress);
  progress.finish();

  report_simplified(a, original, places, best, first_farthest, console);
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
