// Fields that are smooth but for creases: the interface between constructive geometry, which makes them, and
// polygonisation, which puts vertices on their creases.
#pragma once

#include <cstdint>

#include "sansmesh/field/scalar_field.h"

namespace sansmesh {

/// At every point the value is that of one of several smooth functions, its pieces (combined by minima, maxima and
/// changes of sign). Two pieces meet in a crease of the zero set where both vanish, three in a corner.
class PiecewiseField : public ScalarField {
 public:
  /// Number of pieces, numbered from 0.
  virtual std::uint32_t pieces() const = 0;

  /// Which piece is the field at each of x. As many entries as x. Safe from several threads.
  virtual void active(std::span<const Vec3> x, std::span<std::uint32_t> piece) const = 0;

  /// One piece at all of x, wherever it is active, with the sign that it has in the field; `gradients` may be empty.
  /// Safe from several threads.
  virtual void evaluate_piece(std::uint32_t piece, std::span<const Vec3> x, std::span<double> values,
                              std::span<Vec3> gradients) const = 0;
};

}  // namespace sansmesh
