// Field of one or several components in a volume: the interface between volume reconstructions and consumers (probes,
// renderers, polygonisers).
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/query.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Values and gradients have components() entries per point; `inside` marks the volume.
using VolumeFieldValues = ScalarFieldValues;

/// Field of one or several components on a volume. Thread-safe.
class SANSMESH_API VolumeField {
 public:
  /// Allows ownership through a VolumeField pointer.
  virtual ~VolumeField() = default;

  /// Bounding box of the volume.
  virtual Box3 bounds() const = 0;
  /// Number of components: 1 for a scalar, 3 for a vector.
  virtual std::size_t components() const = 0;

  /// Evaluates the requested results at all of x. They are finite everywhere: the field extends smoothly a little
  /// beyond the boundary; farther away it takes the value of some point of the volume. Points that are not finite give
  /// zero. Each result depends on its point only, not on the batch or on threads. Evaluation is fastest if neighbouring
  /// points are adjacent. Sizes must agree. Thread-safe. The field runs in parallel, as ScalarField does: pass all
  /// points in one call.
  virtual void evaluate(std::span<const Vec3> x, const VolumeFieldValues& wanted) const = 0;

  /// Same, through the common interface of fields.
  void query(const QueryPoints& at, const VolumeFieldValues& wanted) const { evaluate(at.points, wanted); }

  /// Distance between neighbouring samples around each of x (length, > 0): the resolution of the data.
  virtual void spacing(std::span<const Vec3> x, std::span<double> found) const = 0;

  /// Bounds the first component within each box, using only bounds known without evaluation. The default is infinite.
  /// As many entries as boxes. Thread-safe.
  virtual void ranges(std::span<const Box3> boxes, std::span<ValueRange> found) const {
    constexpr double kUnknown = std::numeric_limits<double>::infinity();
    std::fill_n(found.begin(), boxes.size(), ValueRange{-kUnknown, kUnknown});
  }
};

}  // namespace sansmesh::inline v1
