#include "sansmesh/points/registration/point_features.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sansmesh/core/parallel.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kFeatureBins = 11;

std::size_t bin_of(double value, double from, double to) {
  const double t = (value - from) / (to - from) * kFeatureBins;
  return t > 0 ? std::min(static_cast<std::size_t>(t), kFeatureBins - 1) : 0;
}

}  // namespace

std::vector<PointFeature> point_features(std::span<const Vec3> points, std::span<const Vec3> normals, double radius) {
  const std::size_t n = points.size();
  std::vector<Vec3f> positions;
  for (const Vec3& p : points) positions.emplace_back(p);
  const KdTree tree(positions);
  std::vector<PointFeature> simple(n), all(n);
  std::vector<std::vector<Neighbour>> near(n);
  parallel_for(0, n, 64, [&](std::size_t i) {
    tree.within(positions[i], static_cast<float>(radius), near[i]);
    PointFeature& f = simple[i];
    f.fill(0);
    double count = 0;
    const Vec3& u = normals[i];
    for (const Neighbour& one : near[i]) {
      const Vec3 offset = points[one.index] - points[i];
      const double distance = norm(offset);
      if (!(distance > 0)) continue;
      const Vec3 d = offset / distance, side = cross(d, u);
      if (!(squared_norm(side) > 1e-12)) continue;
      const Vec3 v = normalized(side), w = cross(u, v);
      const Vec3& other = normals[one.index];
      f[bin_of(dot(v, other), -1, 1)] += 1;
      f[kFeatureBins + bin_of(dot(u, d), -1, 1)] += 1;
      f[2 * kFeatureBins + bin_of(std::atan2(dot(w, other), dot(u, other)), -std::numbers::pi, std::numbers::pi)] += 1;
      count += 1;
    }
    if (count > 0)
      for (float& x : f) x = static_cast<float>(100 * x / count);
  });
  parallel_for(0, n, 256, [&](std::size_t i) {
    std::array<double, 33> sum{};
    double weights = 0;
    for (const Neighbour& one : near[i]) {
      if (one.index == i || !(one.squared_distance > 0)) continue;
      const double w = 1 / std::sqrt(static_cast<double>(one.squared_distance));
      weights += w;
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += w * static_cast<double>(simple[one.index][k]);
    }
    for (std::size_t k = 0; k < sum.size(); ++k)
      all[i][k] =
          weights > 0 ? static_cast<float>((static_cast<double>(simple[i][k]) + sum[k] / weights) / 2) : simple[i][k];
  });
  return all;
}

}  // namespace sansmesh::inline v1
