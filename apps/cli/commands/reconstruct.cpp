// Command `reconstruct`: reconstructs a mesh from points.
#include <fmt/core.h>

#include <string>
#include <utility>
#include <vector>

#include "cli/input/cloud_input.h"
#include "cli/line/commands.h"
#include "cli/line/height_output.h"
#include "cli/line/option_groups.h"
#include "cli/line/schema_options.h"
#include "cli/line/surface_options.h"
#include "cli/report/mesh_words.h"
#include "sansmesh/convert.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/jobs/surfaces/fit_words.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/reconstruct.h"

namespace sansmesh::cli {
namespace {

struct ReconstructArguments {
  CloudInput input;
  MeshOutput output;
  ReconstructOptions options;
  HeightOutput heights;
  SplitOptions tiles;  ///< tiles of the height grid

  bool writes_heights() const { return HeightOutput::is_grid(output.file); }
};

/// The samples to reconstruct: of a height grid, those of the ground unless classes were chosen.
TerrainSamples samples_to_mesh(const ReconstructArguments& a, PointSet points, Console& console) {
  if (!a.writes_heights()) return {std::move(points), 0, 0, {}};
  const std::string name = a.input.name();
  TerrainSamples samples = naming(name, console, [&] {
    return terrain_samples(std::move(points), a.input.classes.has_value(), console.progress());
  });
  console.note(name, samples.notes);
  return samples;
}

/// Words on the mesh, or on the height grid of it.
std::vector<std::string> write_result(const ReconstructArguments& a, const ReconstructResult& made,
                                      const TerrainSamples& samples, Console& console) {
  std::vector<std::string> lines;
  if (!a.writes_heights()) {
    a.output.write(made.mesh, console);
    return lines;
  }
  a.output.write_preview(made.mesh, console);
  const HeightGridResult grid = naming(a.input.name(), console, [&] {
    return make_height_grid(made.mesh, samples, a.heights.options, console.progress(),
                            a.heights.use(a.tiles.tile_size, console));
  });
  a.heights.write(a.output.file, grid, a.tiles.tile_size, a.input.files, lines, console);
  return lines;
}

void check_reconstruct(const ReconstructArguments& a) {
  a.options.validate();
  a.tiles.validate();
  a.heights.check(a.output.file, a.tiles.tile_size, a.input.files);
  if (!a.writes_heights()) {
    require(!a.tiles.tile_size, "--tile-size needs a height grid: -o FILE.tif");
    return a.output.check();
  }
  a.output.check_preview();
  require(!a.output.ascii, "--ascii is for meshes, not for a height grid");
}

void run_reconstruct(const ReconstructArguments& a, Console& console) {
  check_reconstruct(a);
  ReadReport read;
  PointSet points = a.input.read(console, read);
  ReconstructOptions options = a.options;
  options.cloud.classes = a.input.classes;  // none of them is left out by default
  const std::string name = a.input.name(), size = size_words(Vec3(bounds(points).size()));
  const std::size_t count = points.size();
  TerrainSamples samples = samples_to_mesh(a, std::move(points), console);
  const CloudScale scale(samples.points);
  const ReconstructResult made =
      naming(name, console, [&] { return reconstruct(std::move(samples.points), options, console.progress()); });
  console.note(name, made.notes);
  const std::vector<std::string> heights = write_result(a, made, samples, console);
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
  console.print(heights);
  // A closed partition is closed by construction.
  const bool closed =
      (!a.options.other_surface() && !a.options.mesh.trim && !r.open) || measure_topology(made.mesh).closed();
  if (!a.writes_heights())
    print_mesh(a.output.file, made.mesh, static_cast<std::size_t>(r.components), closed, console);
  if (a.options.mesh.measure_quality) console.print(aspect_words(r));
}

}  // namespace

Command add_reconstruct(CommandLine& app) {
  CommandLine& c = app.add_subcommand("reconstruct", "Points → triangle mesh, closed where they bound a solid");
  auto shared = std::make_shared<ReconstructArguments>();
  ReconstructArguments& a = *shared;
  add_cloud_input(c, a.input, "Points, or a mesh or polygon soup");
  add_mesh_output(c, a.output, true, {".tif", "height grid of the ground"});
  add_mesh_options(c, a.options.mesh);
  add_cloud_options(c, a.options.cloud);
  add_fit_options(c, a.options.fit);
  add_surface(c, a.options.surface, a.options.cloud, "Mesh this surface instead");
  add_height_output(c, a.heights, false);
  add_schema(c, a.tiles, {.group = "Height grid", .only = {"tile_size"}});
  c.footer(kReadable + surface_list() +
           "\n\nExamples:\n"
           "  sansmesh reconstruct scan.ply -o surface.ply --preview surface.png\n"
           "  sansmesh reconstruct terrain.las -o terrain.ply --class ground\n"
           "  sansmesh reconstruct terrain.las -o terrain.tif --contours lines.dxf --hillshade shade.png\n"
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
