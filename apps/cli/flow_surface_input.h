// A surface of a flow that a command makes.
#pragma once

#include <optional>
#include <vector>

#include "flow_input.h"
#include "json.h"
#include "sansmesh/flow/flow_surface.h"

namespace sansmesh::cli {

struct FlowSurfaceInput {
  FlowInput flow;
  FlowSurfaceOptions options;
  std::optional<FlowSurfaceKind> kind;
  std::optional<std::size_t> particles;
  std::optional<double> time;
  std::vector<double> sweep;
  bool interpolated = false;
};

/// DATA and the options of flows, --kind, --direction, …
void add_flow_surface_input(CommandLine& command, FlowSurfaceInput& input);

/// Makes it. What there is to say about it goes to the console once the caller has written what it writes. Throws
/// FileError for bad data.
FlowSurface trace_flow_surface(const FlowSurfaceInput& input, const OpenFlow& flow, Console& console);
/// Throws ArgumentError for arguments that do not go together; before anything is read.
void check_flow_surface(const FlowSurfaceInput& input);
void say_flow_surface(const FlowSurface& surface, const OpenFlow& flow, Console& console);
Json flow_surface_json(const FlowSurface& surface);

}  // namespace sansmesh::cli
