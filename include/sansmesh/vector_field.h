// A vector anywhere in space and time, as a rule a velocity: the interface between what makes such fields
// (reconstructions of volumes, formulas) and what follows them (particles, lines and surfaces of a flow), none of which
// knows the other.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/query.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// ∇ · v of the derivatives of v (value per length).
inline double divergence(const Jacobian& j) { return j[0].x + j[1].y + j[2].z; }
/// ∇ × v of the derivatives of v; of a velocity the vorticity: twice the angular velocity.
inline Vec3 curl(const Jacobian& j) { return {j[1].z - j[2].y, j[2].x - j[0].z, j[0].y - j[1].x}; }

/// First and last moment, both included, in the unit of time of the input.
struct TimeRange {
  /// First moment; by default there is none.
  double first = -std::numeric_limits<double>::infinity();
  /// Last moment; by default there is none.
  double last = std::numeric_limits<double>::infinity();

  /// Whether the moment t lies in it.
  bool contains(double t) const { return t >= first && t <= last; }
};

/// A vector, as a rule a velocity, on space and time. Several threads may ask one field at a time.
class SANSMESH_API VectorField {
 public:
  /// Owners may hold it as a VectorField.
  virtual ~VectorField() = default;

  /// Box outside of which it is not defined anywhere.
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

  /// The same by a call of the shape that all fields have. Throws ArgumentError where sizes do not agree.
  void query(const Places& at, const VectorAnswers& wanted) const;
};

}  // namespace sansmesh::inline v1
