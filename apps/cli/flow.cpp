// sansmesh flow: what is done with flows, each a command of its own.
#include "commands.h"
#include "volume_input.h"

namespace sansmesh::cli {

std::vector<Command> add_flow(CommandLine& app) {
  CommandLine& c = app.add_subcommand("flow", "Flows, steady or in time: lines");
  c.require_subcommand();
  c.footer(std::string(kReadableVolumes) +
           "\n\nExamples:\n"
           "  sansmesh flow lines office.vtk --seeds 'line(0,0,1, 4,4,1, 50)' -o lines.vtp");
  return {add_flow_lines(c)};
}

}  // namespace sansmesh::cli
