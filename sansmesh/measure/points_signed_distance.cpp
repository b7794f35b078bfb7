#include "sansmesh/measure/points_signed_distance.h"

#include <cmath>
#include <numbers>

#include "sansmesh/core/boxes.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kRim = 9;  ///< the sample itself and its eight neighbours
/// Steps of the integral over the distance to the nearest sample, and the expected number of nearer samples at its end.
constexpr int kDistanceSteps = 2000;
constexpr double kFarEnough = 40;

}  // namespace

PointsDistance::PointsDistance(const TriangleMesh& points) : points_(points), tree_(points.vertices) {
  if (tree_.size() == 0) throw DataError("no points to measure distances to");
  const Box3f box = finite_bounds(points.vertices);
  bounds_ = {points.origin + Vec3(box.lower), points.origin + Vec3(box.upper)};
  if (points.normals.empty()) return;
  radius_.resize(points.vertices.size());
  tree_.for_each_nearest(kRim, [&](std::uint32_t slot, std::span<const Neighbour> near) {
    radius_[tree_.order()[slot]] = near.empty() ? 0.0f : std::sqrt(near.back().squared_distance);
  });
}

void PointsDistance::measure(std::span<const Vec3> x, double, std::span<MeasuredPoint> found) const {
  for (std::size_t i = 0; i < x.size(); ++i) {
    found[i] = {};
    const Vec3 query = x[i] - points_.origin;
    const auto nearest = tree_.nearest(Vec3f(query));
    if (!nearest) continue;
    const Vec3 sample(points_.vertices[nearest->index]), line = query - sample;
    const Vec3 normal = points_.normals.empty() ? Vec3{} : normalized(Vec3(points_.normals[nearest->index]));
    if (!(squared_norm(normal) > 0)) {
      found[i].distance = norm(line);
      found[i].point = points_.origin + sample;
      continue;
    }
    const double height = dot(line, normal);
    const Vec3 aside = line - normal * height;
    const double lateral = norm(aside), radius = static_cast<double>(radius_[nearest->index]);
    const double over = std::max(0.0, lateral - radius);
    found[i].distance = std::copysign(std::hypot(height, over), height);
    found[i].point = points_.origin + sample + (over > 0 ? aside * (radius / lateral) : aside);
  }
}

double rms_to_samples(double spacing, double noise, bool along_normals) {
  if (!(spacing > 0)) return 0;
  if (!(noise > 1e-6 * spacing)) return along_normals ? 0 : spacing / std::sqrt(std::numbers::pi);
  // A sample at height h is within distance R of a point of the surface if it is within √(R² − h²) along it. With
  // normally distributed heights, the number of samples within R is a Poisson variable with the mean `nearer`.
  struct Within {
    double nearer, height;  // mean number, and their mean squared height
  };
  const auto within = [&](double distance) -> Within {
    const double a = distance / noise, share = std::erf(a / std::numbers::sqrt2);
    const double edge = a * std::exp(-0.5 * a * a) * std::sqrt(2 / std::numbers::pi);
    const double height = share > edge ? noise * noise * (share - edge) / share : 0;
    return {std::numbers::pi / (spacing * spacing) * share * (distance * distance - height), height};
  };
  double end = spacing;
  while (within(end).nearer < kFarEnough) end *= 1.1;
  double sum = 0, none_before = 1;
  for (int i = 1; i <= kDistanceSteps; ++i) {
    const double distance = end * i / kDistanceSteps;
    const double none = std::exp(-within(distance).nearer), middle = end * (i - 0.5) / kDistanceSteps;
    sum += (none_before - none) * (along_normals ? within(middle).height : middle * middle);
    none_before = none;
  }
  return std::sqrt(sum);
}

}  // namespace sansmesh::inline v1
