// The steps of a flow in time, read one at a time.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sansmesh/dataset/volume_flow.h"
#include "sansmesh/volume_options.h"
#include "sansmesh/volume_read_options.h"

namespace sansmesh::inline v1 {

/// Choices of the first step, which hold for all.
struct FlowSeries {
  std::vector<std::string> files;  ///< a step each; of one file its steps
  VolumeReadOptions read;
  DatasetArray array;
  ArrayChoice choice;
  ReconstructionOptions method;
  FlowStep first;
  std::vector<std::string> first_notes;
};

struct FlowStepReader {
  std::function<FlowStep(std::size_t)> read;
  /// "step 3: this; 2 more steps have something of the kind": of what was read until now, beside the first step's.
  std::function<std::vector<std::string>()> notes;
};
/// Throws nothing itself; `read` throws FileError.
FlowStepReader flow_step_reader(FlowSeries series);

/// Speeds and times of particles are floats. Throws DataError for vectors that make others of them.
void check_speeds(const DatasetArray& vectors);

}  // namespace sansmesh::inline v1
