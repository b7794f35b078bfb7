// A surface of a flow that a command makes.
#pragma once

#include "flow_input.h"
#include "sansmesh/flow.h"

namespace sansmesh::cli {

/// DATA and the options of flows, --seeds, --kind, --direction, …
void add_flow_surface_input(CommandLine& command, FlowInput& input, TraceSurfaceOptions& options);

}  // namespace sansmesh::cli
