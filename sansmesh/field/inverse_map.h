// Where a map of space comes from: its inverse at single points, by Newton's method.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/field/space_map.h"

namespace sansmesh {

struct InverseOptions {
  /// Accepted distance between T(v) and the target (length, > 0); default: 1e-10 of the targets' box, or what rounding
  /// leaves of it.
  double tolerance = 0;
  int most_steps = 50;
};

/// A v with T(v) = targets[i] for each, from the starts (as many): damped Newton, whose steps are shortened until they
/// come nearer, and go against the gradient of the distance where the Jacobian has no inverse. `found[i]` is 1 where
/// the tolerance holds; elsewhere (there may be no such v: folds, gaps, beyond where the map is defined) the position
/// is the best that was seen, the start at least. Where space is folded several v are right, and the start decides.
struct InverseAnswers {
  std::vector<Vec3> positions;
  std::vector<std::uint8_t> found;
  std::size_t missed = 0;  ///< how many were not found
};
/// Throws ArgumentError where sizes differ.
InverseAnswers inverse_map(const SpaceMap& map, std::span<const Vec3> targets, std::span<const Vec3> starts,
                           const InverseOptions& options = {});

}  // namespace sansmesh
