// Vector field, usually a velocity, in space and time: the interface between its sources (volume reconstructions,
// formulas) and consumers (particles, lines and surfaces of a flow).
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/query.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Divergence ∇ · v from the derivatives of v (value per length).
inline double divergence(const Jacobian& j) { return j[0].x + j[1].y + j[2].z; }
/// Curl ∇ × v from the derivatives of v; for a velocity the vorticity, twice the angular velocity.
inline Vec3 curl(const Jacobian& j) { return {j[1].z - j[2].y, j[2].x - j[0].z, j[0].y - j[1].x}; }

/// Closed time interval, in the input's unit of time.
struct TimeRange {
  /// start; unbounded by default
  double first = -std::numeric_limits<double>::infinity();
  /// end; unbounded by default
  double last = std::numeric_limits<double>::infinity();

  /// Whether the interval contains the time t.
  bool contains(double t) const { return t >= first && t <= last; }
};

/// Vector field, usually a velocity, on space and time. Thread-safe.
class SANSMESH_API VectorField {
 public:
  /// Allows ownership through a VectorField pointer.
  virtual ~VectorField() = default;

  /// Box that contains the domain at all times.
  virtual Box3 bounds() const = 0;

  /// Times of definition. A steady field is defined, and constant, at all times.
  virtual TimeRange times() const { return {}; }

  /// Sample times, increasing. Between two of them the field is smooth; evaluation is fastest if all points of one
  /// interval precede those of others. Empty if there are none.
  virtual std::span<const double> sample_times() const { return {}; }

  /// Evaluates the vector at position x[i] and time t[i] for every i; a velocity is in input lengths per unit of time.
  /// inside[i] is 1 where the field is defined (in its domain and in times()) and 0 elsewhere; vector and derivatives
  /// are zero there. Positions and times that are not finite are outside. Computes derivatives unless `jacobian` is
  /// empty.
  ///
  /// All spans have the length of x; `jacobian` may be empty. Each result depends on x[i] and t[i] only, not on the
  /// batch. One call per batch, fastest if neighbouring points of one or few times are adjacent. Thread-safe. The field
  /// runs in parallel, as ScalarField does: pass all points in one call.
  virtual void evaluate(std::span<const Vec3> x, std::span<const double> t, std::span<Vec3> vectors,
                        std::span<std::uint8_t> inside, std::span<Jacobian> jacobian = {}) const = 0;

  /// Same, through the common interface of fields. Throws ArgumentError if sizes differ.
  void query(const QueryPoints& at, const VectorFieldValues& wanted) const;
};

}  // namespace sansmesh::inline v1
