#include "sansmesh/points/ground/local_plane.h"

#include <cmath>

#include "sansmesh/core/median.h"

namespace sansmesh::inline v1 {
namespace {

/// Rounds of reweighting, and the deviations from which values have no weight.
constexpr int kReweightings = 3;
constexpr double kReweightDeviations = 3;

}  // namespace

LocalPlane fit_local_plane(std::span<const PlaneValue> values, double unit, std::vector<double>& scratch) {
  LocalPlane plane;
  double scale = 0;
  for (int round = 0; round < kReweightings; ++round) {
    double w = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
    for (const PlaneValue& v : values) {
      const double e = v.z - plane.height - plane.rise_x * v.x - plane.rise_y * v.y;
      const double weight = v.weight * (round > 0 ? tukey_weight(e / (kReweightDeviations * scale)) : 1);
      w += weight, x += weight * v.x, y += weight * v.y, z += weight * v.z;
      xx += weight * v.x * v.x, xy += weight * v.x * v.y, yy += weight * v.y * v.y;
      xz += weight * v.x * v.z, yz += weight * v.y * v.z;
    }
    if (!(w > 0)) break;
    // A slight ridge keeps slopes across a row of values at 0.
    const double ridge = 1e-5 * (xx + yy - (x * x + y * y) / w) + 1e-12 * unit * unit;
    const double cxx = xx - x * x / w + ridge, cyy = yy - y * y / w + ridge, cxy = xy - x * y / w;
    const double cxz = xz - x * z / w, cyz = yz - y * z / w, determinant = cxx * cyy - cxy * cxy;
    plane.rise_x = (cxz * cyy - cyz * cxy) / determinant, plane.rise_y = (cyz * cxx - cxz * cxy) / determinant;
    plane.height = (z - plane.rise_x * x - plane.rise_y * y) / w;
    scratch.clear();
    for (const PlaneValue& v : values)
      scratch.push_back(std::abs(v.z - plane.height - plane.rise_x * v.x - plane.rise_y * v.y));
    scale = kDeviationOverMedian * median(scratch) + 1e-3 * unit;
  }
  return plane;
}

}  // namespace sansmesh::inline v1
