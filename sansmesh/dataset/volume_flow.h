// The vectors of a volume, or of a series of volumes in time, as a flow.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "sansmesh/field/vector_field.h"
#include "sansmesh/field/volume_field.h"

namespace sansmesh {

/// A field of two (then z is 0) or three components as a steady flow. Throws ArgumentError for others.
std::unique_ptr<VectorField> volume_flow(std::shared_ptr<const VolumeField> field);

enum class TimeInterpolation : std::uint8_t {
  constant,  ///< that of the step before, as in the source (METHODS §5.2)
  linear,    ///< between the two steps around
  cubic      ///< through the two before and the two after: smooth in time
};

/// A flow whose steps are read when they are asked for; grids may differ from step to step. As many steps are kept as
/// one moment needs (1, 2 or 4) and one more, which is read ahead.
/// `times`: of the steps, strictly increasing, two at least. `load(i)` is called for one step at a time, not always by
/// the same thread; what it throws comes out of evaluate(). Throws ArgumentError for other times.
std::unique_ptr<VectorField> flow_in_time(std::vector<double> times,
                                          std::function<std::shared_ptr<const VolumeField>(std::size_t)> load,
                                          TimeInterpolation interpolation);

}  // namespace sansmesh
