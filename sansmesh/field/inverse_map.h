// Pointwise inverse of a map of space by Newton's method.
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
  /// Accepted distance between T(v) and the target (length, > 0); default: 1e-10 of the size of the targets' box, at
  /// least the rounding error of its coordinates.
  double tolerance = 0;
  int most_steps = 50;
};

/// Computes v with T(v) = targets[i] for each target, from as many start points, by damped Newton: steps are shortened
/// until the distance decreases, and follow the negative gradient of the distance where the Jacobian is singular.
/// `found[i]` is 1 if the tolerance is reached; otherwise (no solution: folds, gaps, outside the domain of the map) the
/// position is the best one found, at least the start. Where space is folded, several solutions exist and the start
/// selects one.
struct InvertedPoints {
  std::vector<Vec3> positions;
  std::vector<std::uint8_t> found;
  std::size_t missed = 0;  ///< number of targets not reached
};
/// Throws ArgumentError if sizes differ.
InvertedPoints inverse_map(const SpaceMap& map, std::span<const Vec3> targets, std::span<const Vec3> starts,
                           const InverseOptions& options = {});

/// Inverse of a map as a map; the inverse of a backward map is a forward map. Undefined (NaN) where no solution is
/// found. Has no gaps: their points have no source.
class InverseMap final : public SpaceMap {
 public:
  /// `tolerance` as in InverseOptions, > 0. `starts`: an approximate inverse, for example the forward map of the same
  /// handles; null: each point is its own start.
  InverseMap(std::shared_ptr<const SpaceMap> map, double tolerance, std::shared_ptr<const SpaceMap> starts = {})
      : map_(std::move(map)), starts_(std::move(starts)), tolerance_(tolerance) {}

  void map(std::span<const Vec3> x, const MappedPoints& wanted) const override;

 private:
  std::shared_ptr<const SpaceMap> map_, starts_;
  double tolerance_;
};

}  // namespace sansmesh::inline v1
