// Interface of signed distances to a surface.
#pragma once

#include <limits>
#include <span>

#include "sansmesh/box.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct MeasuredPoint {
  /// Positive outside; NaN where the surface is farther than requested or was not found.
  double distance = std::numeric_limits<double>::quiet_NaN();
  Vec3 point;           ///< closest point of the surface, approximately; world coordinates
  bool border = false;  ///< the closest point is on the border of an open mesh
  bool lost = false;    ///< no surface was found, although it may be near
};

/// A surface to measure from, in world coordinates.
class SignedDistance {
 public:
  virtual ~SignedDistance() = default;

  /// Bounding box of the surface.
  virtual Box3 bounds() const = 0;
  /// false: all distances are positive, since the sides are indistinguishable.
  virtual bool has_sides() const { return true; }
  /// Distances at all x, one call per batch; spatially ordered points are fastest. Sizes must agree. Distances above
  /// `farthest` may be NaN; those of non-finite points are. Thread-safe. Unlike a field it has no internal parallelism:
  /// callers with many points distribute batches in a loop.
  virtual void measure(std::span<const Vec3> x, double farthest, std::span<MeasuredPoint> found) const = 0;
};

}  // namespace sansmesh::inline v1
