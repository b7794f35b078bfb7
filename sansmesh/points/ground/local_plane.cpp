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
    PlaneSums sums;
    for (const PlaneValue& v : values) {
      const double e = v.z - plane.height - plane.rise_x * v.x - plane.rise_y * v.y;
      const double weight = v.weight * (round > 0 ? tukey_weight(e / (kReweightDeviations * scale)) : 1);
      sums.add(v.x, v.y, v.z, weight);
    }
    if (!(sums.w > 0)) break;
    // A slight ridge keeps slopes across a row of values at 0.
    const double spread = sums.xx + sums.yy - (sums.x * sums.x + sums.y * sums.y) / sums.w;
    plane = sums.plane(sums.central(1e-5 * spread + 1e-12 * unit * unit));
    scratch.clear();
    for (const PlaneValue& v : values)
      scratch.push_back(std::abs(v.z - plane.height - plane.rise_x * v.x - plane.rise_y * v.y));
    scale = kDeviationOverMedian * median(scratch) + 1e-3 * unit;
  }
  return plane;
}

}  // namespace sansmesh::inline v1
