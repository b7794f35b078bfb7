// sansmesh reconstruct: points in, closed mesh out.
#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "commands.h"
#include "sansmesh/io/io.h"
#include "sansmesh/polygonize/mesh_topology.h"

namespace sansmesh::cli {
namespace {

struct InputSize {
  std::size_t points;
  Vec3f extent;
};

void print_report(const ReconstructArguments& arguments, const ReadReport& read, const InputSize& input,
                  const ReconstructReport& report, const TriangleMesh& mesh, Console& console) {
  console.say(fmt::format("{}: {}, {} × {} × {} ({})", arguments.input, counted(input.points, "point"),
                          length(input.extent[0]), length(input.extent[1]), length(input.extent[2]), read.format));
  const std::optional<SurfaceOptions>& surface = arguments.options.surface;
  console.say(fmt::format("spacing {}, noise {}, {} in {} down to depth {}", length(report.spacing),
                          length(report.noise), surface ? surface->method : counted(report.fits, "local fit"),
                          counted(report.blocks, "block"), report.depth));
  // The partition is closed by construction.
  const bool closed = (!surface && !arguments.options.trim) || measure_topology(mesh).closed();
  console.say(fmt::format("{}: {}, {} in {}{}", arguments.output, counted(mesh.triangles.size(), "triangle"),
                          grouped(mesh.vertices.size()) + " vertices",
                          counted(static_cast<unsigned long long>(report.components), "component"),
                          closed ? ", closed" : ", with borders"));
  if (arguments.options.measure_quality)
    console.say(fmt::format("aspect ratio {:.3f} ± {:.3f} before enhancement, {:.3f} ± {:.3f} after",
                            report.aspect_mean_before, report.aspect_deviation_before, report.aspect_mean,
                            report.aspect_deviation));
}

}  // namespace

void run_reconstruct(const ReconstructArguments& arguments, Console& console) {
  arguments.options.validate();
  check_writable(arguments.output, "mesh");
  if (!arguments.preview.empty()) check_writable(arguments.preview, "image");

  Progress& progress = console.progress();
  progress.begin("read");
  ReadReport read;
  PointSet points = read_points(arguments.input, &read);
  const InputSize size{points.size(), bounds(points).size()};
  console.warn(arguments.input, read.warnings);

  ReconstructReport report;
  TriangleMesh mesh;
  try {
    mesh = reconstruct(std::move(points), arguments.options, progress, &report);
  } catch (const DataError& error) {
    throw FileError(arguments.input, error.what());
  }
  console.warn(arguments.input, report.warnings);

  Image preview;
  if (!arguments.preview.empty()) preview = render_mesh(mesh, {}, progress);
  progress.begin("write");
  write_mesh(arguments.output, mesh, {.ascii = arguments.ascii});
  if (!arguments.preview.empty()) write_image(arguments.preview, preview);
  progress.finish();

  print_report(arguments, read, size, report, mesh, console);
  if (console.options().json) {
    const MeshTopology topology = measure_topology(mesh);
    nlohmann::ordered_json json;
    json["input"] = {{"file", arguments.input}, {"format", read.format}, {"points", size.points}};
    json["spacing"] = report.spacing;
    json["noise"] = report.noise;
    json["depth"] = report.depth;
    json["blocks"] = report.blocks;
    json["fits"] = report.fits;
    json["output"] = {{"file", arguments.output},           {"vertices", mesh.vertices.size()},
                      {"triangles", mesh.triangles.size()}, {"components", report.components},
                      {"closed", topology.closed()},        {"mesh_error", report.mesh_error}};
    if (arguments.options.measure_quality)
      json["aspect_ratio"] = {{"mean_before", report.aspect_mean_before},
                              {"deviation_before", report.aspect_deviation_before},
                              {"mean", report.aspect_mean},
                              {"deviation", report.aspect_deviation}};
    for (const Progress::Timing& t : progress.timings())
      json["stages"].push_back({{"stage", t.stage}, {"wall_s", t.wall_seconds}, {"cpu_s", t.cpu_seconds}});
    std::vector<std::string> warnings = read.warnings;
    warnings.insert(warnings.end(), report.warnings.begin(), report.warnings.end());
    json["warnings"] = warnings;
    console.say_json(json.dump(2));
  }
  console.print_timings();
}

}  // namespace sansmesh::cli
