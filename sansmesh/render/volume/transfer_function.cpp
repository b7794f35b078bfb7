#include "sansmesh/volume_look.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "sansmesh/error.h"
#include "sansmesh/render/scene/color_space.h"

namespace sansmesh::inline v1 {
namespace {

/// The first point beyond a value; jumps take effect at their value.
template <class Point>
std::size_t point_after(const std::vector<Point>& points, double value) {
  const auto after =
      std::upper_bound(points.begin(), points.end(), value, [](double v, const Point& p) { return v < p.value; });
  return static_cast<std::size_t>(after - points.begin());
}

template <class Point>
void check_order(const std::vector<Point>& points, const char* field) {
  if (points.empty()) throw ArgumentError(fmt::format("`{}` must hold at least one point", field));
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!std::isfinite(points[i].value)) throw ArgumentError(fmt::format("`{}`: point {} is not finite", field, i + 1));
    if (i > 0 && points[i].value < points[i - 1].value)
      throw ArgumentError(
          fmt::format("`{}` must ascend: {:g} comes after {:g}", field, points[i].value, points[i - 1].value));
  }
}

}  // namespace

Vec3f TransferFunction::color(double value) const {
  const std::size_t after = point_after(colors, value);
  if (after == 0) return colors.front().color;
  if (after == colors.size() || mixing == ColorMixing::step) return colors[after - 1].color;
  const ColorPoint &a = colors[after - 1], &b = colors[after];
  const double t = (value - a.value) / (b.value - a.value);
  if (mixing == ColorMixing::rgb) return Vec3f(Vec3(a.color) * (1 - t) + Vec3(b.color) * t);
  return srgb_of_lab(lab_of_srgb(a.color) * (1 - t) + lab_of_srgb(b.color) * t);
}

double TransferFunction::opacity(double value) const {
  const std::size_t after = point_after(opacities, value);
  if (after == 0) return opacities.front().opacity;
  if (after == opacities.size()) return opacities.back().opacity;
  const OpacityPoint &a = opacities[after - 1], &b = opacities[after];
  return a.opacity + (b.opacity - a.opacity) * ((value - a.value) / (b.value - a.value));
}

std::pair<double, double> TransferFunction::range() const {
  return {std::min(colors.front().value, opacities.front().value),
          std::max(colors.back().value, opacities.back().value)};
}

TransferFunction TransferFunction::over(double lower, double upper) const {
  const auto [from, to] = range();
  const double scale = to > from ? (upper - lower) / (to - from) : 0;
  TransferFunction moved = *this;
  for (ColorPoint& p : moved.colors) p.value = lower + (p.value - from) * scale;
  for (OpacityPoint& p : moved.opacities) p.value = lower + (p.value - from) * scale;
  return moved;
}

void TransferFunction::validate() const {
  check_order(colors, "colors");
  check_order(opacities, "opacities");
  for (const ColorPoint& p : colors)
    for (std::size_t k = 0; k < 3; ++k)
      if (!(p.color[k] >= 0 && p.color[k] <= 1))
        throw ArgumentError(fmt::format("`colors` must be in 0..1, not {:g} (at {:g})", p.color[k], p.value));
  for (const OpacityPoint& p : opacities)
    if (!(p.opacity >= 0 && p.opacity <= 1))
      throw ArgumentError(fmt::format("`opacities` must be in 0..1, not {:g} (at {:g})", p.opacity, p.value));
  if (reference_length && !(*reference_length > 0 && std::isfinite(*reference_length)))
    throw ArgumentError(fmt::format("`reference_length` must be positive, not {:g}", *reference_length));
}

}  // namespace sansmesh::inline v1
