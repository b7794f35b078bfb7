// Steps of an unsteady flow, read one at a time.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sansmesh/dataset/volume_flow.h"
#include "sansmesh/volume_options.h"
#include "sansmesh/volume_read_options.h"

namespace sansmesh::inline v1 {

/// Choices made at the first step, which apply to all; without a given `smoothing` each step is smoothed by its noise.
struct FlowSeries {
  std::vector<std::string> files;  ///< one file per step, or a single file with all steps
  VolumeReadOptions read;
  DatasetArray array;
  ArrayChoice choice;
  VolumeReconstructionOptions method;
  FlowStep first;
  std::vector<std::string> first_notes;
};

struct FlowStepReader {
  std::function<FlowStep(std::size_t)> read;
  /// "step 3: this; 2 more steps have similar notes": notes on the steps read so far, except the first.
  std::function<std::vector<std::string>()> notes;
};
/// `read` throws FileError.
FlowStepReader flow_step_reader(FlowSeries series);

/// Throws DataError for vectors whose particle speeds or times exceed the range of float.
void check_speeds(const DatasetArray& vectors);

}  // namespace sansmesh::inline v1
