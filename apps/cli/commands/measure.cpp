// Command `measure`: area, volume, centre of mass, moments and size of a solid and its parts.
#include "sansmesh/inspect.h"

#include <fmt/core.h>

#include <memory>
#include <string>

#include "cli/input/surface_input.h"
#include "cli/line/commands.h"

namespace sansmesh::cli {
namespace {

void run_measure(const CloudInput& input, Console& console) {
  const SurfaceInput opened = open_surface(input, console);
  const std::string& file = opened.surface.name();
  const MeasureResult made = measure(opened.surface, console.progress());
  const SolidMeasures& m = made.measures;
  console.note(file, made.notes);
  console.report(opened.report, "input");
  console.report(m);

  console.print(
      fmt::format("{}: {} vertices, {}", file, grouped(m.topology.vertices), counted(m.whole.triangles, "triangle")));
  console.print(summary_of(m));
  console.print("(lengths in the unit of the input; moments about the centre of mass, for density 1)");
}

}  // namespace

Command add_measure(CommandLine& app) {
  CommandLine& c = app.add_subcommand("measure", "Mesh or function → area, volume, centre of mass, moments, size");
  auto input = std::make_shared<CloudInput>();
  add_surface_input(
      c, "input", input->files,
      "Mesh, function (.smf) or DATA[NAME=VALUE] of a volume (measured by their mesh); several meshes are one body");
  c.footer(
      "Volumes need a closed surface. Coincident borders, edge on edge, count as joined. Components are\n"
      "listed with --json, up to a thousand of them.\n\n"
      "Examples:\n"
      "  sansmesh measure part.ply\n"
      "  sansmesh measure part.stl --json");
  c.announce({report_of<ReadSurface>("input"), report_of<SolidMeasures>()});
  return {&c, [input](Console& console) { run_measure(*input, console); }};
}

}  // namespace sansmesh::cli
