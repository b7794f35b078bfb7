#include <fmt/core.h>

#include "sansmesh/attribute_table.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/data/world_points.h"
#include "sansmesh/field/curvature_field.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/functions.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sansmesh::inline v1 {
namespace {

/// Step of the second differences, in sample spacings.
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

ProbeFunctionResult probe_function(const SurfaceFunction& probed, std::span<const Vec3> points, Progress& progress) {
  progress.begin("evaluate");
  const FittedFunction& function = probed.fitted();
  const std::size_t n = points.size();
  std::vector<Vec3> x(n);
  for (std::size_t i = 0; i < n; ++i) x[i] = function.frame.from_input(points[i]);
  ProbeFunctionResult result;
  std::vector<LevelSetPoint> values(n);
  level_set_points(function.field, x, kLevelSetStep * function.field.report().spacing, values);
  result.values.reserve(n);
  for (std::size_t i = 0; i < n; ++i) result.values.push_back({values[i], points[i]});
  const double unit = function.frame.unit;
  ProbeFunctionReport& r = result.report;
  r.points = n;
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

std::vector<Vec3> positions_of(const PointSet& points) { return world_points(points.origin, points.positions); }

std::vector<std::string> summary_of(const ProbeFunctionResult& probed) {
  const ProbeFunctionReport& r = probed.report;
  std::vector<std::string> lines{fmt::format("{} evaluated, {} inside", counted(r.points, "point"), grouped(r.inside))};
  if (r.points > kListedPoints)
    lines.push_back(fmt::format("|value|: mean {}, median {}, largest {}; largest gradient {:.3f}",
                                length_words(r.mean), length_words(r.median), length_words(r.largest),
                                r.largest_gradient));
  else
    for (const ProbedPoint& v : probed.values)
      lines.push_back(fmt::format("{}  value {:.6g}  gradient {}  curvatures {:.4g}, {:.4g}", point_words(v.at, 8),
                                  v.value, point_words(v.gradient), v.k1, v.k2));
  return lines;
}

const ReportSchema& ProbeFunctionReport::schema() {
  static constexpr ReportRow rows[] = {
      reported<&ProbeFunctionReport::points>({.text = "Evaluated points"}),
      reported<&ProbeFunctionReport::inside>({.text = "Points inside"}),
      reported<&ProbeFunctionReport::mean>(
          {.name = "absolute_value.mean", .text = "Mean of the absolute values", .unit = "length"}),
      reported<&ProbeFunctionReport::median>(
          {.name = "absolute_value.median", .text = "Median of the absolute values", .unit = "length"}),
      reported<&ProbeFunctionReport::largest>(
          {.name = "absolute_value.max", .text = "Largest absolute value", .unit = "length"}),
      reported<&ProbeFunctionReport::largest_gradient>({.text = "Largest gradient"})};
  return report_schema<rows>();
}

const ReportSchema& ProbedPoint::schema() {
  static constexpr ReportRow rows[] = {
      reported<&ProbedPoint::at>({.text = "Query point", .unit = "length"}),
      reported<[](const ProbedPoint& r) { return r.value; }>(
          {.name = "value", .text = "Value, approximately the distance from the surface", .unit = "length"}),
      reported<[](const ProbedPoint& r) { return r.gradient; }>({.name = "gradient", .text = "Gradient"}),
      reported<[](const ProbedPoint& r) { return r.k1; }>(
          {.name = "k1", .text = "Larger principal curvature of the level set", .unit = "1/length"}),
      reported<[](const ProbedPoint& r) { return r.k2; }>(
          {.name = "k2", .text = "Smaller principal curvature of the level set", .unit = "1/length"})};
  return report_schema<rows>();
}

}  // namespace sansmesh::inline v1
