#include "sansmesh/core/diverging_color.h"

#include <algorithm>
#include <cmath>

namespace sansmesh::inline v1 {
namespace {

float gamma_encoded(double linear) {
  linear = std::clamp(linear, 0.0, 1.0);
  return static_cast<float>(linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055);
}

}  // namespace

Vec3f diverging_color(float t) {
  t = std::isfinite(t) ? std::clamp(t, -1.0f, 1.0f) : t > 0 ? 1.0f : t < 0 ? -1.0f : 0.0f;
  const double s = std::abs(static_cast<double>(t));
  // Both ends have the same lightness and chroma, within sRGB.
  const double angle = t < 0 ? 4.53 : 0.45, chroma = 0.155 * s, lightness = 0.98 - 0.48 * s;
  const double a = chroma * std::cos(angle), b = chroma * std::sin(angle);
  const auto cube = [](double v) { return v * v * v; };
  const double l = cube(lightness + 0.3963377774 * a + 0.2158037573 * b);
  const double m = cube(lightness - 0.1055613458 * a - 0.0638541728 * b);
  const double k = cube(lightness - 0.0894841775 * a - 1.2914855480 * b);
  return {gamma_encoded(4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * k),
          gamma_encoded(-1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * k),
          gamma_encoded(-0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * k)};
}

}  // namespace sansmesh::inline v1
