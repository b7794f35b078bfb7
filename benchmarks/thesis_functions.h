// Test functions for volume reconstructions on the unit cube (tejada2008, 6.3).
#pragma once

#include <cmath>

#include "sansmesh/vec.h"

namespace sansmesh::benchmark {

inline double f1(const Vec3& p) {
  return (1.25 + std::cos(5.4 * p.y)) * std::cos(6 * p.z) / (6 + 6 * (3 * p.x - 1) * (3 * p.x - 1));
}
inline double f2(const Vec3& p) { return (std::tanh(9 * p.z - 9 * p.x - 9 * p.y) + 1) / 9; }
inline double f3(const Vec3& p) {
  const auto sq = [](double v) { return v * v; };
  const double x = 9 * p.x, y = 9 * p.y, z = 9 * p.z;
  return 0.75 * std::exp(-(sq(x - 2) + sq(y - 2) + sq(z - 2)) / 4) +
         0.75 * std::exp(-sq(x + 1) / 49 - (y + 1) / 10 - (z + 1) / 10) +
         0.5 * std::exp(-(sq(x - 7) + sq(y - 3) + sq(z - 5)) / 4) - 0.2 * std::exp(-sq(x - 4) - sq(y - 7) - sq(z - 5));
}

}  // namespace sansmesh::benchmark
