// A flow that a command reads: the vectors of a volume, of a series of volumes in time, or a formula.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/input/volume_input.h"
#include "sansmesh/flow.h"

namespace sansmesh::cli {

/// A report on a flow that was read.
struct ReadFlow : ReadFiles {
  std::optional<VolumeUse> volume;  ///< of steady ones
  std::string vectors;

  static const ReportSchema& schema();
};

struct FlowInput {
  VolumeInput volume;
  FlowModelOptions flow;

  /// Warnings go to the console.
  FlowModel open(Console& console) const;
  ReadFlow told(const FlowModel& opened, Progress& progress) const;
};

/// DATA, --array and --method, --unsteady, --times, --time-interpolation and --memory.
void add_flow_input(CommandLine& command, FlowInput& input);
/// The same with the options of the surfaces of a flow: --seeds, --kind, --direction, …
void add_flow_surface_input(CommandLine& command, FlowInput& input, TraceSurfaceOptions& options);

/// --times
void add_times_option(CommandLine& command, std::vector<double>& times, const char* group = nullptr);

/// What the footers of these commands say of DATA.
inline constexpr const char* kFlowsByFormula =
    "DATA may also be a flow by formula: rotation, helix, saddle, abc, double-gyre, tornado or past-sphere.\n\n";

}  // namespace sansmesh::cli
