// sansmesh reconstruct: points in, mesh out.
#include <fmt/core.h>

#include <utility>

#include "cloud_input.h"
#include "commands.h"
#include "option_groups.h"
#include "sansmesh/error.h"
#include "sansmesh/io.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/reconstruct.h"
#include "surface_options.h"

namespace sansmesh::cli {
namespace {

struct ReconstructArguments {
  CloudInput input;
  MeshOutput output;
  ReconstructOptions options;
};

struct InputSize {
  std::size_t points;
  Vec3f extent;
  CloudScale scale;
};

/// What was decided on whether the surface bounds a solid, and why.
std::string openness(const ReconstructReport& r, std::optional<bool> asked) {
  if (asked) return *asked ? "open, as asked: the surface ends where the samples end" : "closed, as asked";
  const std::string why = fmt::format("winding number {:.2f} behind the samples", r.behind);
  if (r.open_share <= 0) return fmt::format("closed ({})", why);
  if (r.open_share > 0.995) return fmt::format("open ({}): the surface ends where the samples end", why);
  return fmt::format("{:.0f} % open ({}): there the surface ends where the samples end", 100 * r.open_share, why);
}

void print_report(const ReconstructArguments& arguments, const ReadReport& read, const InputSize& input,
                  const ReconstructReport& report, const TriangleMesh& mesh, Console& console) {
  console.say(fmt::format("{}: {}, {} × {} × {} ({})", arguments.input.name(), counted(input.points, "point"),
                          length(input.extent[0]), length(input.extent[1]), length(input.extent[2]), read.format));
  const bool other = arguments.options.other_surface();
  const std::string made =
      other ? arguments.options.surface.method
            : fmt::format("{} down to depth {}", counted(report.fits, "local fit"), report.fit_depth);
  console.say(fmt::format("spacing {}, noise {}, {}, meshed in {} down to depth {}", length(input.scale.spacing),
                          input.scale.noise_words(), made, counted(report.blocks, "block"), report.block_depth));
  if (report.paper)
    for (const std::string& line : paper_words(*report.paper, report.fits_of_degree)) console.say(line);
  if (report.simplices > 0) console.say("walked through " + grouped(report.simplices) + " simplices");
  console.say("normals " + normals_made(report.estimated_normals, report.oriented_by));
  if (!report.alignment.empty()) console.say(report.alignment);
  if (!other && !report.paper) console.say(openness(report, arguments.options.fit.open));
  // A closed partition is closed by construction.
  const bool closed = (!other && !arguments.options.mesh.trim && !report.open) || measure_topology(mesh).closed();
  console.say(fmt::format("{}: {}, {} in {}{}", arguments.output.file, counted(mesh.triangles.size(), "triangle"),
                          grouped(mesh.vertices.size()) + " vertices",
                          counted(static_cast<unsigned long long>(report.components), "component"),
                          closed ? ", closed" : ", with borders"));
  if (arguments.options.mesh.measure_quality) say_aspect_ratios(report, console);
}

void run_reconstruct(const ReconstructArguments& arguments, Console& console) {
  arguments.options.validate();
  arguments.output.check();

  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  PointSet points = arguments.input.read(console, read);
  const InputSize size{points.size(), bounds(points).size(), CloudScale(points)};

  const auto [mesh, report, notes] = naming(
      arguments.input.name(), console, [&] { return reconstruct(std::move(points), arguments.options, progress); });
  console.note(arguments.input.name(), notes);

  arguments.output.write(mesh, progress);
  progress.finish();

  print_report(arguments, read, size, report, mesh, console);
  if (console.options().json) {
    const MeshTopology topology = measure_topology(mesh);
    Json json;
    json["input"] = arguments.input.json(read, size.points);
    size.scale.add_to(json);
    json["deviation"] = report.noise;
    json["normals"] = normals_made_json(report.estimated_normals, report.oriented_by);
    if (arguments.options.cloud.align) json["alignment"] = report.alignment;
    json["fits"] = report.fits;
    json["fit_depth"] = report.fit_depth;
    if (!arguments.options.other_surface()) json["fits_of_degree"] = report.fits_of_degree;
    if (report.paper) json["paper"] = paper_json(*report.paper);
    if (report.simplices > 0) json["simplices"] = report.simplices;
    json["open_share"] = report.open_share;
    json["winding_number_behind"] = report.behind;
    json["lost_share"] = report.lost;
    json["blocks"] = report.blocks;
    json["block_depth"] = report.block_depth;
    json["output"] = {{"file", arguments.output.file},      {"vertices", mesh.vertices.size()},
                      {"triangles", mesh.triangles.size()}, {"components", report.components},
                      {"closed", topology.closed()},        {"mesh_error", report.mesh_error}};
    if (arguments.options.mesh.measure_quality)
      json["aspect_ratio"] = {{"mean_before", report.aspect_mean_before},
                              {"deviation_before", report.aspect_deviation_before},
                              {"mean", report.aspect_mean},
                              {"deviation", report.aspect_deviation}};
    for (const Progress::Timing& t : progress.timings())
      json["stages"].push_back({{"stage", t.stage}, {"wall_s", t.wall_seconds}, {"cpu_s", t.cpu_seconds}});
    console.say_json(json);
  }
  console.print_timings();
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
  add_surface(c, a.options.surface, a.options.cloud, "Cut another surface out, as it stands");
  c.footer(kReadable + surface_list() +
           "\n\nExamples:\n"
           "  sansmesh reconstruct scan.ply -o surface.ply --preview surface.png\n"
           "  sansmesh reconstruct terrain.las -o terrain.ply --class ground\n"
           "  sansmesh reconstruct west.las east.las -o ground.ply --class ground\n"
           "  sansmesh reconstruct scans.conf -o object.ply --align\n"
           "  sansmesh reconstruct part.ply -o part.stl --surface apss --sharp\n"
           "  sansmesh reconstruct part.xyz -o part.stl --mesh-error 0.05 --components largest");
  return {&c, [shared](Console& console) {
            if (shared->options.surface.normal == SurfaceOptions::Normal::iterated)
              throw ArgumentError("--normal iterated is for pictures and points: meshes have no normals but their own");
            run_reconstruct(*shared, console);
          }};
}

}  // namespace sansmesh::cli
