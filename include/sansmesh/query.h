// The one shape of a batch of questions to a field: places in, values with their gradients out, and which places lie
// where the field is defined.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Where, and when, a field is asked. Neighbouring points in neighbouring slots go fastest.
struct Places {
  std::span<const Vec3> points;  ///< in coordinates of the field
  /// Of every point its moment, of one entry that of all of them. Only flows that change heed it: where it is empty
  /// they are asked for the moment 0.
  std::span<const double> times = {};
};

/// What is wanted at a batch of places; spans that are empty are not wanted. Others are as long as the places, of
/// fields of several components values and gradients so many times as long, those of a place side by side.
template <class Value, class Gradient>
struct Answers {
  std::span<Value> values = {};         ///< one of each component a place
  std::span<Gradient> gradients = {};   ///< their derivatives by the position
  std::span<std::uint8_t> inside = {};  ///< 1 where the field is defined, else 0
};

/// Derivatives of a vector v by the position: [k] = ∂v/∂x_k, per time if v is a velocity.
using Jacobian = std::array<Vec3, 3>;

/// Of ScalarField and VolumeField: gradients are values per length.
using ScalarAnswers = Answers<double, Vec3>;
/// Of VectorField, and of SpaceMap, whose values are positions.
using VectorAnswers = Answers<Vec3, Jacobian>;

}  // namespace sansmesh::inline v1
