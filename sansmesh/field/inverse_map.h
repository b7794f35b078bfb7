// Where a map of space comes from: its inverse at single points, by Newton's method.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "sansmesh/space_map.h"

namespace sansmesh::inline v1 {

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

/// The inverse of a map as a map: from places before to places after, if the map is a backward one. Where none is found
/// it is not defined (NaN). It has no gaps: what they show comes from nowhere.
class InverseMap final : public SpaceMap {
 public:
  /// `tolerance` as in InverseOptions, > 0. `starts`: a map that comes near, such as the forward one of the same
  /// handles; null: each place starts at itself.
  InverseMap(std::shared_ptr<const SpaceMap> map, double tolerance, std::shared_ptr<const SpaceMap> starts = {})
      : map_(std::move(map)), starts_(std::move(starts)), tolerance_(tolerance) {}

  void map(std::span<const Vec3> x, const MapAnswers& wanted) const override;

 private:
  std::shared_ptr<const SpaceMap> map_, starts_;
  double tolerance_;
};

}  // namespace sansmesh::inline v1
