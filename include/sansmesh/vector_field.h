// A vector anywhere in space and time, as a rule a velocity: the interface between what makes such fields
// (reconstructions of volumes, formulas) and what follows them (particles, lines and surfaces of a flow), none of which
// knows the other.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Derivatives of a vector v by the position: [k] = ∂v/∂x_k, per time if v is a velocity.
using Jacobian = std::array<Vec3, 3>;

/// ∇ · v.
inline double divergence(const Jacobian& j) { return j[0].x + j[1].y + j[2].z; }
/// ∇ × v; of a velocity the vorticity: twice the angular velocity.
inline Vec3 curl(const Jacobian& j) { return {j[1].z - j[2].y, j[2].x - j[0].z, j[0].y - j[1].x}; }

/// First and last moment, both included, in the unit of time of the input.
struct TimeRange {
  double first = -std::numeric_limits<double>::infinity();
  double last = std::numeric_limits<double>::infinity();

  bool contains(double t) const { return t >= first && t <= last; }
};

class SANSMESH_API VectorField {
 public:
  virtual ~VectorField() = default;

  /// Outside it is not defined anywhere.
  virtual Box3 bounds() const = 0;

  /// When it is defined. A steady field is the same at all times, and defined at all.
  virtual TimeRange times() const { return {}; }

  /// Moments of samples in time, increasing: between two of them the field is smooth, and asked there for all places
  /// before it is asked for others it goes fastest. None where there are no such moments.
  virtual std::span<const double> moments() const { return {}; }

  /// The vector at position x[i] at the moment t[i], for every i: a velocity is in lengths of the input per its unit of
  /// time. inside[i] becomes 1 where the field is defined (in its domain, and in times()) and 0 elsewhere; there the
  /// vector and its derivatives are zero. Positions and moments that are not finite are not inside. If `jacobian` is
  /// not empty it gets the derivatives.
  ///
  /// All spans have the length of x; `jacobian` may be empty. Each answer depends on x[i] and t[i] alone, not on the
  /// rest of the batch. One call a batch: neighbouring points in neighbouring slots, of one moment or of few, evaluate
  /// fastest. Safe from several threads at a time. As with ScalarField the field itself runs in parallel: whoever asks
  /// hands over all points that it has.
  virtual void evaluate(std::span<const Vec3> x, std::span<const double> t, std::span<Vec3> vectors,
                        std::span<std::uint8_t> inside, std::span<Jacobian> jacobian = {}) const = 0;
};

}  // namespace sansmesh::inline v1
