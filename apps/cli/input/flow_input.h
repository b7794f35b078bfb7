// Flow that a command reads: the vectors of a volume, of a series of volumes in time, or a formula.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/input/volume_input.h"
#include "sansmesh/flow.h"

namespace sansmesh::cli {

/// Report of a flow that was read.
struct ReadFlow : ReadFiles {
  std::optional<VolumeUse> volume;  ///< of a steady flow
  std::string vectors;

  static const ReportSchema& schema();
};

struct FlowInput {
  VolumeInput volume;
  FlowModelOptions flow;

  /// Warnings are sent to the console.
  FlowModel open(Console& console) const;
  ReadFlow report(const FlowModel& opened, Progress& progress) const;
};

/// DATA, --array and --method, --unsteady, --times, --time-interpolation and --memory.
void add_flow_input(CommandLine& command, FlowInput& input);
/// Also adds the options of flow surfaces: --seeds, --kind, --direction, …
void add_flow_surface_input(CommandLine& command, FlowInput& input, TraceSurfaceOptions& options);

/// --times
void add_times_option(CommandLine& command, std::vector<double>& times, const char* group = nullptr);

/// Footer text about DATA of these commands.
inline constexpr const char* kFlowsByFormula =
    "DATA may also be a flow by formula: rotation, helix, saddle, abc, double-gyre, tornado or past-sphere.\n\n";

}  // namespace sansmesh::cli
