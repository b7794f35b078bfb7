// Vector arrays of a volume, or of a time series of volumes, as a flow.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "sansmesh/vector_field.h"
#include "sansmesh/volume_field.h"
#include "sansmesh/volume_options.h"

namespace sansmesh::inline v1 {

/// A field of two (z is then 0) or three components as a steady flow. Throws ArgumentError for others.
std::unique_ptr<VectorField> volume_flow(std::shared_ptr<const VolumeField> field);

/// One step of a series.
struct FlowStep {
  std::shared_ptr<const VolumeField> field;
  std::size_t bytes = 0;             ///< approximate memory (ReconstructionReport::bytes)
  std::function<void()> taken = {};  ///< called once when the step is first needed, not when it is read ahead
};

struct FlowSeriesOptions {
  TimeInterpolation interpolation = TimeInterpolation::linear;
  /// Bytes. Steps already read are kept while they and the one read ahead fit: repeated passes (from the start for each
  /// front of a surface that receives new particles; for derivatives along lines) then need not read again. Steps
  /// needed at the current time are kept in any case.
  std::uint64_t memory = 0;
};

/// A flow that reads steps on demand; grids may differ between steps, and bounds() are those of the first. A point in
/// time between steps is inside where all contributing steps (1, 2 or 4) are; at the time of a step only that step
/// contributes. One further step is read ahead. If the series exceeds `memory`, the steps passed most recently are
/// dropped, since a new pass begins with the others.
/// `times`: times of the steps, strictly increasing, at least two. `load(i)` is called for one step at a time, not
/// always from the same thread; its exceptions propagate from the evaluate() that needs the step. Throws ArgumentError
/// for other times.
std::unique_ptr<VectorField> flow_in_time(std::vector<double> times, std::function<FlowStep(std::size_t)> load,
                                          const FlowSeriesOptions& options = {});

}  // namespace sansmesh::inline v1
