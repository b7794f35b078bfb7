// Command `reconstruct`: reconstructs a mesh from points.
#include <fmt/core.h>

#include <string>
#include <utility>
#include <vector>

#include "cli/input/cloud_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"
#include "cli/line/surface_options.h"
#include "cli/report/mesh_words.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/jobs/fit_words.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/reconstruct.h"

namespace sansmesh::cli {
namespace {

struct ReconstructArguments {
  CloudInput input;
  MeshOutput output;
  ReconstructOptions options;
};

void run_reconstruct(const ReconstructArguments& a, Console& console) {
  a.options.validate();
  a.output.check();
  ReadReport read;
  PointSet points = a.input.read(console, read);
  ReconstructOptions options = a.options;
  options.cloud.classes = a.input.classes;  // none of them is left out by default
  const std::string name = a.input.name(), size = size_words(Vec3(bounds(points).size()));
  const std::size_t count = points.size();
  const CloudScale scale(points);
  const ReconstructResult made =
      naming(name, console, [&] { return reconstruct(std::move(points), options, console.progress()); });
  console.note(name, made.notes);
  a.output.write(made.mesh, console);
  console.report(a.input.report(read, count), "input");
  console.report(scale);
  console.report(made.report);
  console.report_stages();
  if (!console.prints_text()) return;

  const ReconstructReport& r = made.report;
  console.print(fmt::format("{}: {}, {} ({})", name, counted(count, "point"), size, read.format));
  std::vector<std::string> lines = summary_of(r, a.options);
  lines[0] = fmt::format("spacing {}, noise {}, {}", length(scale.spacing), scale.noise_words(), lines[0]);
  console.print(lines);
  // A closed partition is closed by construction.
  const bool closed =
      (!a.options.other_surface() && !a.options.mesh.trim && !r.open) || measure_topology(made.mesh).closed();
  print_mesh(a.output.file, made.mesh, static_cast<std::size_t>(r.components), closed, console);
  if (a.options.mesh.measure_quality) console.print(aspect_words(r));
}

}  // namespace

Command add_reconstruct(CommandLine& app) {
  CommandLine& c = app.add_subcommand("reconstruct", "Points → triangle mesh, closed where they bound a solid");
  auto shared = std::make_shared<ReconstructArguments>();
  ReconstructArguments& a = *shared;
  add_cloud_input(c, a.input, "Points, or a mesh or polygon soup");
  add_mesh_output(c, a.output);
  add_mesh_options(c, a.options.mesh);
  add_cloud_options(c, a.options.cloud);
  add_fit_options(c, a.options.fit);
  add_surface(c, a.options.surface, a.options.cloud, "Mesh this surface instead");
  c.footer(kReadable + surface_list() +
           "\n\nExamples:\n"
           "  sansmesh reconstruct scan.ply -o surface.ply --preview surface.png\n"
           "  sansmesh reconstruct terrain.las -o terrain.ply --class ground\n"
           "  sansmesh reconstruct west.las east.las -o ground.ply --class ground\n"
           "  sansmesh reconstruct scans.conf -o object.ply --align\n"
           "  sansmesh reconstruct part.ply -o part.stl --surface apss --sharp\n"
           "  sansmesh reconstruct part.xyz -o part.stl --mesh-error 0.05 --components largest");
  c.announce({report_of<ReadCloud>("input"), report_of<CloudScale>(), report_of<ReconstructReport>()});
  return {&c, [shared](Console& console) {
            if (shared->options.surface.normal == SurfaceOptions::Normal::iterated)
              throw ArgumentError("--normal iterated is for pictures and points, not for meshes");
            run_reconstruct(*shared, console);
          }};
}

}  // namespace sansmesh::cli
