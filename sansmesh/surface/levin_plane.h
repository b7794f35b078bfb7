// Levin's reference plane by its defining minimisation.
#pragma once

#include <span>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// A sample within reach of a point, in double precision.
struct WeighedSample {
  Vec3 x, n;
  double factor = 1;         ///< constant factor of the weight
  double inverse_width = 1;  ///< compact: 1 / (2h)²; Gaussian: 1 / h²
  bool gaussian = false;

  /// Weight at this squared distance, and its derivative with respect to that.
  double weight(double square, double* slope = nullptr) const;
};

struct LevinPlane {
  Vec3 normal;        ///< unit
  double offset = 0;  ///< t: the plane passes through r + t · normal
  int steps = 0;      ///< steps of the minimisation
};

/// Σ ⟨n, x_i − r − t n⟩² w_i(‖x_i − r − t n‖) and its derivatives with respect to t and, tangentially, to n (levin2003;
/// tejada2008, ch. 2).
double levin_energy(std::span<const WeighedSample> samples, const Vec3& r, const LevinPlane& plane, Vec3* by_normal,
                    double* by_offset);

/// Local minimum of levin_energy over n and t by descent from `start` (BFGS with a line search, over the hemisphere
/// around start.normal), until the derivatives vanish to rounding or no step lowers it. `width`: length of the weights,
/// which limits the steps, because the sum also vanishes far from all samples.
LevinPlane least_levin_plane(std::span<const WeighedSample> samples, const Vec3& r, const LevinPlane& start,
                             double width);

}  // namespace sansmesh::inline v1::detail
