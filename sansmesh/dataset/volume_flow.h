// The vectors of a volume, or of a series of volumes in time, as a flow.
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

/// A field of two (then z is 0) or three components as a steady flow. Throws ArgumentError for others.
std::unique_ptr<VectorField> volume_flow(std::shared_ptr<const VolumeField> field);

/// A step of a series, as it was read.
struct FlowStep {
  std::shared_ptr<const VolumeField> field;
  std::size_t bytes = 0;             ///< that it takes, about (ReconstructionReport::bytes)
  std::function<void()> taken = {};  ///< called when a step that was read is needed, once; not when it is read ahead
};

struct FlowSeriesOptions {
  TimeInterpolation interpolation = TimeInterpolation::linear;
  /// Bytes. Steps that were read are kept as long as all of them, and the one that is read ahead, take no more: what
  /// comes back to them (a pass from the start for each front of a surface that gets new particles, the derivatives
  /// along lines) need not read them again. Those that the moment needs are kept whatever they take.
  std::uint64_t memory = 0;
};

/// A flow whose steps are read when they are asked for; grids may differ from step to step, and bounds() are those of
/// the first. A moment between two steps is inside where all steps are that have a share in it (1, 2 or 4 of them): a
/// moment of a step asks for that step alone. One more step is read ahead. Of series larger than `memory` the steps
/// that go are those that were passed last: who comes back begins with the others.
/// `times`: of the steps, strictly increasing, two at least. `load(i)` is called for one step at a time, not always by
/// the same thread; what it throws comes out of evaluate() that needs the step. Throws ArgumentError for other times.
std::unique_ptr<VectorField> flow_in_time(std::vector<double> times, std::function<FlowStep(std::size_t)> load,
                                          const FlowSeriesOptions& options = {});

}  // namespace sansmesh::inline v1
