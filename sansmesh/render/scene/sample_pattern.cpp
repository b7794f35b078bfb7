#include "sansmesh/render/scene/sample_pattern.h"

#include <numbers>

namespace sansmesh::inline v1 {

std::vector<Spot> spread_over_disc(int count) {
  std::vector<Spot> spots;
  for (int i = 0; i < count; ++i) {
    const double u = std::fmod(0.5 + 0.7548776662466927 * i, 1.0), v = std::fmod(0.5 + 0.5698402909980532 * i, 1.0);
    const double r = std::sqrt(u), angle = 2 * std::numbers::pi * v;
    spots.push_back({static_cast<float>(r * std::cos(angle)), static_cast<float>(r * std::sin(angle))});
  }
  return spots;
}

}  // namespace sansmesh::inline v1
