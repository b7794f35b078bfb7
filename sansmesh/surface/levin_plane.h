// Levin's plane by the minimisation that defines it.
#pragma once

#include <span>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// A sample in reach of a point, in double precision.
struct WeighedSample {
  Vec3 x, n;
  double factor = 1;         ///< what it counts for, besides its distance
  double inverse_width = 1;  ///< compact: 1 / (2h)²; Gaussian: 1 / h²
  bool gaussian = false;

  /// Its weight at this squared distance, and the derivative of that by it.
  double weight(double square, double* slope = nullptr) const;
};

struct LevinPlane {
  Vec3 normal;        ///< unit
  double offset = 0;  ///< t: the plane passes through r + t · normal
  int steps = 0;      ///< of the minimisation
};

/// Σ ⟨n, x_i − r − t n⟩² w_i(‖x_i − r − t n‖) and its derivatives by t and, across n, by n (Levin 2003; tejada2008 §2).
double levin_energy(std::span<const WeighedSample> samples, const Vec3& r, const LevinPlane& plane, Vec3* by_normal,
                    double* by_offset);

/// The local minimum of levin_energy over n and t that descent from `start` leads to (BFGS with a line search, over the
/// hemisphere around start.normal), until the derivatives vanish to rounding or no step lowers it. `width`: length of
/// the weights. No step is longer than a share of it: far from all samples the sum vanishes, too.
LevinPlane least_levin_plane(std::span<const WeighedSample> samples, const Vec3& r, const LevinPlane& start,
                             double width);

}  // namespace sansmesh::inline v1::detail
