// sansmesh smooth: noise taken off a mesh.
#include <fmt/core.h>

#include <cmath>
#include <utility>

#include "commands.h"
#include "mesh_words.h"
#include "option_groups.h"
#include "sansmesh/core/error.h"
#include "sansmesh/io/io.h"
#include "sansmesh/mesh/mesh_topology.h"
#include "sansmesh/mesh/smooth_mesh.h"

namespace sansmesh::cli {
namespace {

/// Of the diagonal: more is not noise.
constexpr double kFar = 0.01;

struct SmoothArguments {
  std::string input;
  MeshOutput output;
  SmoothOptions options;
};

void run_smooth(const SmoothArguments& a, Console& console) {
  a.options.validate();
  a.output.check();
  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  TriangleMesh mesh = read_mesh(a.input, &read);
  std::vector<std::string> warnings = read.warnings;
  const SmoothReport r = smooth_mesh(mesh, a.options, progress);
  if (r.shortened)
    warnings.push_back(fmt::format("waves of {} are longer than {} rounds take off: its edges are {} long on average",
                                   length(*a.options.length), grouped(static_cast<std::size_t>(r.iterations)),
                                   length(r.mean_edge)));
  const double diagonal = bounds(mesh).diagonal();
  if (diagonal > 0 && r.rms_move > kFar * diagonal)
    warnings.push_back(fmt::format(
        "moved by {:.1f} % of the diagonal, at most by {:.1f} %: edges of {} are too long to smooth away no shape{}",
        100 * r.rms_move / diagonal, 100 * r.largest_move / diagonal, length(r.mean_edge),
        a.options.creases ? "" : " (--iterations 2, --creases, or more triangles)"));
  for (std::string& line : loss_words(read, a.output.file, mesh)) warnings.push_back(std::move(line));
  console.warn(a.input, warnings);
  a.output.write(mesh, progress);
  progress.finish();

  console.say(fmt::format("{}: {}, {} vertices, edges {} long on average", a.input,
                          counted(mesh.triangles.size(), "triangle"), grouped(r.vertices), length(r.mean_edge)));
  console.say(
      fmt::format("moved by {} (root mean square), at most {}; {} at borders and edges of three triangles stayed",
                  length(r.rms_move), length(r.largest_move), grouped(r.fixed)));
  const auto change = [](double before, double after) { return 100 * (after - before) / std::abs(before); };
  std::string size = fmt::format("area {:+.3f} %", change(r.area_before, r.area_after));
  if (r.volume_before && r.volume_after)
    size += fmt::format(", volume {:+.3f} %", change(std::abs(*r.volume_before), std::abs(*r.volume_after)));
  console.say(size);
  console.say(fmt::format("{}: {}{}", a.output.file, counted(static_cast<std::size_t>(r.iterations), "round"),
                          a.options.creases ? fmt::format(", creases of more than {:.0f}° kept", r.crease_angle) : ""));
  Json json = {
      {"input",
       {{"file", a.input}, {"vertices", r.vertices}, {"triangles", mesh.triangles.size()}, {"mean_edge", r.mean_edge}}},
      {"iterations", r.iterations},
      {"moved", {{"rms", r.rms_move}, {"max", r.largest_move}, {"fixed", r.fixed}}},
      {"area", {{"before", r.area_before}, {"after", r.area_after}}},
      {"volume", {{"before", r.volume_before}, {"after", r.volume_after}}},
      {"output", output_json(a.output.file, mesh, measure_topology(mesh))}};
  if (a.options.creases) json["crease_angle_deg"] = r.crease_angle;
  console.say_json(json);
  console.print_timings();
}

}  // namespace

Command add_smooth(CommandLine& app) {
  CommandLine& c = app.add_subcommand("smooth", "Mesh → mesh without its noise, its volume or its creases kept");
  auto a = std::make_shared<SmoothArguments>();
  SmoothOptions& o = a->options;
  c.add_option("input", a->input, "Mesh").type_name("FILE").required();
  add_mesh_output(c, a->output);
  c.add_option("--iterations", o.iterations, "Rounds, 1..10000 [10; with --creases 8]").type_name("COUNT");
  c.add_option("--strength", o.strength, "How far a round goes, above 0 and up to 0.65 [0.6]").type_name("SHARE");
  c.add_option("--length", o.length, "Take off what is shorter than this, in place of --iterations")
      .type_name("LENGTH");
  c.add_flag("--creases", o.creases, "Keep creases: smooth the normals of faces, and fit the vertices to them");
  c.add_option("--crease-angle", o.crease_angle,
               "With --creases: faces that are turned by more do not blur, 1..90 [from the noise]")
      .type_name("DEGREES");
  c.add_flag("--borders", o.borders, "Smooth borders, too, along themselves; otherwise they stay");
  c.footer(
      "Vertices move, triangles stay as they are. Reported: how far, and the change of volume.\n\n"
      "Examples:\n"
      "  sansmesh smooth scan.ply -o smooth.ply\n"
      "  sansmesh smooth scan.ply -o smoother.ply --length 2.5\n"
      "  sansmesh smooth part.stl -o part.ply --creases");
  return {&c, [a](Console& console) { run_smooth(*a, console); }};
}

}  // namespace sansmesh::cli
