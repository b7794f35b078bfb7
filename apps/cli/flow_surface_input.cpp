#include "flow_surface_input.h"

#include <fmt/core.h>

#include "command_line.h"
#include "schema_options.h"

namespace sansmesh::cli {

void add_flow_surface_input(CommandLine& c, FlowInput& input, TraceSurfaceOptions& options) {
  add_flow_input(c, input);
  const std::vector<std::string_view> fronts = {"alpha", "beta", "delta", "interpolated", "front_step"},
                                      steps = {"integrator", "tolerance", "step_length"};
  std::vector<std::string_view> others = {"most_fronts", "most_points", "least_speed", "most_steps"};
  others.insert(others.end(), fronts.begin(), fronts.end());
  others.insert(others.end(), steps.begin(), steps.end());
  add_schema(c, options, {.without = others});
  add_schema(c, options, {.group = "Fronts", .only = fronts});
  add_schema(c, options, {.group = "Steps", .only = steps});
}

}  // namespace sansmesh::cli
