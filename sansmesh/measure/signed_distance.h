// How far a point lies from a surface, and on which side: the interface.
#pragma once

#include <limits>
#include <span>

#include "sansmesh/box.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct MeasuredPoint {
  /// Positive outside; NaN where the surface is farther than asked or could not be found.
  double distance = std::numeric_limits<double>::quiet_NaN();
  Vec3 point;           ///< closest of the surface, or nearly so; world coordinates
  bool border = false;  ///< the closest point lies on the border of an open mesh: the surface ends there
  bool lost = false;    ///< no surface was found though nothing says that it is far
};

/// A surface to measure from. Coordinates are those of the world.
class SignedDistance {
 public:
  virtual ~SignedDistance() = default;

  /// Of the surface.
  virtual Box3 bounds() const = 0;
  /// false: all distances are positive, since nothing tells the sides apart.
  virtual bool has_sides() const { return true; }
  /// Distances at all of x, one call per batch; neighbours in neighbouring slots go fastest. Sizes must agree. What
  /// lies farther than `farthest` may be NaN. Points that are not finite are. Safe from several threads: whoever has
  /// many points cuts them into batches and asks in a loop, since this, unlike a field, has none.
  virtual void measure(std::span<const Vec3> x, double farthest, std::span<MeasuredPoint> found) const = 0;
};

}  // namespace sansmesh::inline v1
