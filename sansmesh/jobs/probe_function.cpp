#include "sansmesh/attribute_table.h"
#include "sansmesh/field/level_set_curvature.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/functions.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sansmesh::inline v1 {
namespace {

/// Step of the second derivatives over the spacing of the samples.
constexpr double kLevelSetStep = 0.25;

}  // namespace

void ProbeFunctionResult::add_to(AttributeTable& attributes) const {
  const auto add = [&](const char* name, auto&& get) {
    std::vector<float> column(values.size());
    for (std::size_t i = 0; i < column.size(); ++i) column[i] = static_cast<float>(get(values[i]));
    attributes.set(name, std::move(column));
  };
  add("value", [](const LevelSetPoint& p) { return p.value; });
  add("gradient_x", [](const LevelSetPoint& p) { return p.gradient.x; });
  add("gradient_y", [](const LevelSetPoint& p) { return p.gradient.y; });
  add("gradient_z", [](const LevelSetPoint& p) { return p.gradient.z; });
  add("k1", [](const LevelSetPoint& p) { return p.k1; });
  add("k2", [](const LevelSetPoint& p) { return p.k2; });
}

ProbeFunctionResult probe_function(const SurfaceFunction& probed, std::span<const Vec3> places, Progress& progress) {
  progress.begin("evaluate");
  const FittedFunction& function = probed.fitted();
  const std::size_t n = places.size();
  std::vector<Vec3> x(n);
  for (std::size_t i = 0; i < n; ++i) x[i] = function.place.from_input(places[i]);
  ProbeFunctionResult result;
  result.values.resize(n);
  level_set_points(function.field, x, kLevelSetStep * function.field.report().spacing, result.values);
  const double unit = function.place.unit;
  ProbeFunctionReport& r = result.report;
  std::vector<double> size(n);
  for (std::size_t i = 0; i < n; ++i) {
    LevelSetPoint& p = result.values[i];
    p.value *= unit, p.k1 /= unit, p.k2 /= unit;
    size[i] = std::abs(p.value);
    r.inside += p.value < 0;
    r.largest_gradient = std::max(r.largest_gradient, norm(p.gradient));
  }
  if (n == 0) return result;
  std::sort(size.begin(), size.end());
  for (const double s : size) r.mean += s / static_cast<double>(n);
  r.median = size[n / 2], r.largest = size[n - 1];
  return result;
}

std::vector<Vec3> places_of(const PointSet& points) {
  std::vector<Vec3> places(points.size());
  for (std::size_t i = 0; i < places.size(); ++i) places[i] = points.origin + Vec3(points.positions[i]);
  return places;
}

}  // namespace sansmesh::inline v1
