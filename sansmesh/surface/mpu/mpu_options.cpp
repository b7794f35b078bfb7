#include "sansmesh/surface/mpu/mpu_options.h"

#include <algorithm>
#include <cmath>

#include "sansmesh/core/check_range.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr double kErrorOfSpacing = 0.05, kErrorOfNoise = 5;

}  // namespace

void MpuOptions::validate() const {
  if (error && !(std::isfinite(*error) && *error > 0)) throw ArgumentError("`error` must be a positive length");
  if (max_depth) check_range("max_depth", *max_depth, 2, 14);
}

double default_mpu_error(double spacing, double noise) {
  return std::max(kErrorOfSpacing * spacing, kErrorOfNoise * noise);
}

}  // namespace sansmesh::inline v1
