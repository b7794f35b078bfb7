// Planes of heights by least squares.
#pragma once

#include <span>
#include <vector>

namespace sansmesh::inline v1 {

/// Position relative to the point of the plane, with its weight.
struct PlaneValue {
  double x, y, z, weight;
};

/// Height at 0 and slopes.
struct LocalPlane {
  double height = 0, rise_x = 0, rise_y = 0;
};

/// Weighted sums over positions, of which a plane follows.
struct PlaneSums {
  double w = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0, zz = 0;

  void add(double px, double py, double pz, double weight) {
    w += weight, x += weight * px, y += weight * py, z += weight * pz;
    xx += weight * px * px, xy += weight * px * py, yy += weight * py * py;
    xz += weight * px * pz, yz += weight * py * pz, zz += weight * pz * pz;
  }
  void add(const PlaneSums& o) {
    w += o.w, x += o.x, y += o.y, z += o.z, xx += o.xx, xy += o.xy, yy += o.yy, xz += o.xz, yz += o.yz, zz += o.zz;
  }

  /// Sums about the mean. `ridge` is added to those of x² and y².
  struct Central {
    double xx, xy, yy, xz, yz, zz, determinant;
  };
  Central central(double ridge = 0) const {
    Central c{xx - x * x / w + ridge,
              xy - x * y / w,
              yy - y * y / w + ridge,
              xz - x * z / w,
              yz - y * z / w,
              zz - z * z / w,
              0};
    c.determinant = c.xx * c.yy - c.xy * c.xy;
    return c;
  }
  /// The plane, if the determinant is positive.
  LocalPlane plane(const Central& c) const {
    const double a = (c.xz * c.yy - c.yz * c.xy) / c.determinant, b = (c.yz * c.xx - c.xz * c.xy) / c.determinant;
    return {(z - a * x - b * y) / w, a, b};
  }
};

/// Weighted least squares with reweighting: values several deviations off have no weight. `unit`: length that is large
/// compared to rounding errors. `scratch` saves allocations.
LocalPlane fit_local_plane(std::span<const PlaneValue> values, double unit, std::vector<double>& scratch);

}  // namespace sansmesh::inline v1
