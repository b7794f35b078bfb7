// Command `flow surface`: stream, path, streak and time surfaces.
#include "sansmesh/flow.h"

#include <fmt/core.h>

#include <memory>
#include <string>

#include "cli/input/flow_input.h"
#include "cli/line/commands.h"
#include "cli/line/option_groups.h"

namespace sansmesh::cli {
namespace {

struct FlowSurfaceArguments {
  FlowInput input;
  TraceSurfaceOptions options;
  MeshOutput mesh;
};

void run_flow_surface(const FlowSurfaceArguments& a, Console& console) {
  a.mesh.check();
  a.options.validate();
  const FlowModel flow = a.input.open(console);
  const TraceSurfaceResult made = trace_surface(flow, a.options, console.progress());
  const TriangleMesh& mesh = made.surface.mesh;
  a.mesh.write(mesh, console);
  console.note(flow.source(), made.notes);
  console.report(a.input.report(flow, console.progress()), "input");
  console.report(made);

  console.print_named(flow.name(), summary_of(made.surface.report));
  console.print(fmt::format("{}: {}, {} vertices, area {:.6g}", a.mesh.file, counted(mesh.triangles.size(), "triangle"),
                            grouped(mesh.vertices.size()), made.area));
}

}  // namespace

Command add_flow_surface(CommandLine& flow) {
  CommandLine& c = flow.add_subcommand("surface", "Flow and a seed curve → stream, path, streak or time surface");
  auto shared = std::make_shared<FlowSurfaceArguments>();
  add_flow_surface_input(c, shared->input, shared->options);
  add_mesh_output(c, shared->mesh);
  c.footer(
      std::string("The vertices of the mesh have s (position on the curve), time, speed and front.\n") +
      kFlowsByFormula +
      "Examples:\n"
      "  sansmesh flow surface office.vtk --seeds 'line(0.5,0.5,1, 4,4,1, 200)' -o stream.ply --preview stream.png\n"
      "  sansmesh flow surface eddies.nek5000 --unsteady --seeds 'line(1,1,0, 5,5,0, 200)' -o path.ply\n"
      "  sansmesh flow surface tornado --seeds 'circle(0.5,0.5,0.02, 0,0,1, 0.2, 100)' --duration 5 -o tube.ply");
  c.announce({report_of<ReadFlow>("input"), report_of<TraceSurfaceResult>()});
  return {&c, [shared](Console& console) { run_flow_surface(*shared, console); }};
}

}  // namespace sansmesh::cli
