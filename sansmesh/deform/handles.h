// What a user moves: handles, each with its place before and after the deformation.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// A unit direction before and after.
struct TurnedDirection {
  Vec3 before, after;
};

/// A point that went from p to q, or a segment from p to *p_end that went to q to *q_end (for `alpha` of 1 and above).
struct Handle {
  Vec3 p, q;
  std::optional<Vec3> p_end, q_end;  ///< both or neither

  /// Directions that went with it: one is the normal of a plane through the point, three orthonormal ones are a frame.
  /// They count as points so far from the handle (in both directions) as `reach` says would.
  std::vector<TurnedDirection> directions;
  /// Length, > 0; default: half the mean distance from a handle to the nearest other one, after the deformation
  /// (of the forward map: before it).
  std::optional<double> reach;

  double weight = 1;  ///< multiplies its influence, > 0
  std::string group;  ///< handles of one group turn as one body between poses
};

/// The same the other way round: what was after is before.
inline std::vector<Handle> reversed(std::vector<Handle> handles) {
  for (Handle& h : handles) {
    std::swap(h.p, h.q);
    std::swap(h.p_end, h.q_end);
    for (TurnedDirection& d : h.directions) std::swap(d.before, d.after);
  }
  return handles;
}

}  // namespace sansmesh::inline v1
