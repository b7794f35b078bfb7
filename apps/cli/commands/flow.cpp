// Command `flow`: group of commands on flows.
#include "cli/input/volume_input.h"
#include "cli/line/commands.h"

namespace sansmesh::cli {

std::vector<Command> add_flow(CommandLine& app) {
  CommandLine& c = app.add_subcommand("flow", "Flows, steady or in time: lines, surfaces, pictures");
  c.footer(std::string(kReadableVolumes) +
           "\n\nExamples:\n"
           "  sansmesh flow lines office.vtk --seeds 'line(0,0,1, 4,4,1, 50)' -o lines.vtp\n"
           "  sansmesh flow surface tornado --seeds 'circle(0.5,0.5,0.02, 0,0,1, 0.2, 100)' --duration 5 -o tube.ply");
  return {add_flow_lines(c), add_flow_surface(c), add_flow_render(c)};
}

}  // namespace sansmesh::cli
