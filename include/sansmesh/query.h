// Common interface of batch queries to fields: positions in; values, gradients and domain membership out.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Query points and times. Evaluation is fastest if neighbouring points are adjacent in the batch.
struct QueryPoints {
  std::span<const Vec3> points;  ///< in coordinates of the field
  /// One time per point, or one time for all points. Only unsteady flows use it; if empty, the time is 0.
  std::span<const double> times = {};
};

/// Requested results of a batch of points; empty spans are not computed. Other spans have one entry per point, or one
/// per component for values and gradients, with the components of a point adjacent.
template <class Value, class Gradient>
struct FieldValues {
  std::span<Value> values = {};         ///< one per component and point
  std::span<Gradient> gradients = {};   ///< derivatives with respect to position
  std::span<std::uint8_t> inside = {};  ///< 1 where the field is defined, else 0
};

/// Derivatives of a vector v with respect to position: [k] = ∂v/∂x_k, per time if v is a velocity.
using Jacobian = std::array<Vec3, 3>;

/// Results of ScalarField and VolumeField: gradients are values per length.
using ScalarFieldValues = FieldValues<double, Vec3>;
/// Results of VectorField, and of SpaceMap, whose values are positions.
using VectorFieldValues = FieldValues<Vec3, Jacobian>;

}  // namespace sansmesh::inline v1
