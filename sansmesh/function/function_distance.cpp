#include "sansmesh/function/function_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/field/placed_field.h"
#include "sansmesh/function/mesh_function.h"
#include "sansmesh/measure/mesh_signed_distance.h"
#include "sansmesh/meshing/mesh_options.h"

namespace sansmesh {
namespace {

constexpr std::size_t kBatch = 1024;

/// A step from 1 at `a` to 0 at `b`, with its derivative.
std::pair<double, double> fading(double t, double a, double b) {
  const double u = std::clamp((t - a) / (b - a), 0.0, 1.0);
  return {1 - u * u * (3 - 2 * u), -6 * u * (1 - u) / (b - a)};
}

TriangleMesh whole_mesh(const SurfaceFunction& function, Progress& progress) {
  MeshOptions options;
  options.components.kind = ComponentChoice::Kind::all;
  options.carry_colors = false;
  return mesh_function(function, options, progress);
}

}  // namespace

struct FunctionDistance::Parts {
  Parts(std::shared_ptr<const SurfaceFunction> f, Progress& progress)
      : function(std::move(f)),
        field(function->field, function->place),
        mesh(whole_mesh(*function, progress)),
        distance(mesh),
        near(std::max(function->place.to_input(function->field.report().spacing),
                      1e-6 * distance.bounds().diagonal())) {}

  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const;
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const;
  /// Distances to the mesh, with the function's sign.
  std::vector<MeasuredPoint> measure(std::span<const Vec3> x) const {
    std::vector<MeasuredPoint> found(x.size());
    distance.measure(x, std::numeric_limits<double>::max(), found);
    // The side: that of the function next to the closest point. A mesh has its folds, and normals there that mislead.
    std::vector<Vec3> beside(x.begin(), x.end());
    for (std::size_t i = 0; i < x.size(); ++i) {
      const double d = std::abs(found[i].distance);
      if (d > near) beside[i] = found[i].point + (x[i] - found[i].point) * (near / d);
    }
    std::vector<double> side(x.size());
    field.evaluate(beside, side);
    for (std::size_t i = 0; i < x.size(); ++i)
      if (std::abs(side[i]) > 0.25 * near) found[i].distance = std::copysign(found[i].distance, side[i]);
    return found;
  }

  std::shared_ptr<const SurfaceFunction> function;
  PlacedField field;
  TriangleMesh mesh;
  MeshDistance distance;
  double near;  ///< one spacing
};

FunctionDistance::FunctionDistance(std::shared_ptr<const SurfaceFunction> function, Progress& progress)
    : parts_(std::make_unique<Parts>(std::move(function), progress)) {}

FunctionDistance::~FunctionDistance() = default;

Box3 FunctionDistance::bounds() const { return parts_->field.bounds(); }

/// Of points that go together.
void FunctionDistance::Parts::evaluate(std::span<const Vec3> x, std::span<double> values,
                                       std::span<Vec3> gradients) const {
  const std::vector<MeasuredPoint> found = measure(x);
  std::vector<std::size_t> close;
  std::vector<Vec3> at;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double d = found[i].distance;
    values[i] = d;
    if (!gradients.empty()) gradients[i] = d != 0 ? (x[i] - found[i].point) / d : Vec3{};
    if (!(std::abs(d) < 2 * near)) continue;
    close.push_back(i);
    at.push_back(x[i]);
  }
  if (close.empty()) return;
  std::vector<double> value(close.size());
  std::vector<Vec3> slope(gradients.empty() ? 0 : close.size());
  field.evaluate(at, value, slope);
  for (std::size_t j = 0; j < close.size(); ++j) {
    const std::size_t i = close[j];
    const double d = values[i], gap = value[j] - d;
    const auto [share, share_slope] = fading(std::abs(d), near, 2 * near);
    const auto [trust, trust_slope] = fading(std::abs(gap), 0.5 * near, near);
    const double weight = share * trust;
    values[i] = d + weight * gap;
    if (gradients.empty()) continue;
    const Vec3 away = gradients[i], across = slope[j] - away;
    gradients[i] =
        away + across * weight +
        (away * (std::copysign(share_slope, d) * trust) + across * (std::copysign(trust_slope, gap) * share)) * gap;
    if (!is_finite(gradients[i])) gradients[i] = slope[j];
  }
}

void FunctionDistance::Parts::ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const {
  const std::vector<MeasuredPoint> measured = measure(x);
  std::vector<std::size_t> close;
  std::vector<Vec3> at;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double d = measured[i].distance;
    found[i] = {d - radius, d + radius};
    if (!(std::abs(d) < 2 * near + radius)) continue;
    close.push_back(i);
    at.push_back(x[i]);
  }
  std::vector<ValueRange> of_function(close.size());
  if (!close.empty()) field.ranges(at, radius, of_function);
  for (std::size_t j = 0; j < close.size(); ++j) {
    ValueRange& r = found[close[j]];
    r = {std::min(r.least, of_function[j].least), std::max(r.most, of_function[j].most)};
  }
}

void FunctionDistance::evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const {
  parallel_ranges(0, x.size(), kBatch, [&](std::size_t first, std::size_t last) {
    const std::size_t n = last - first;
    parts_->evaluate(x.subspan(first, n), values.subspan(first, n),
                     gradients.empty() ? gradients : gradients.subspan(first, n));
  });
}

void FunctionDistance::ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const {
  parallel_ranges(0, x.size(), kBatch, [&](std::size_t first, std::size_t last) {
    const std::size_t n = last - first;
    parts_->ranges(x.subspan(first, n), radius, found.subspan(first, n));
  });
}

}  // namespace sansmesh
