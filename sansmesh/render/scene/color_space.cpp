#include "sansmesh/render/scene/color_space.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sansmesh/render/scene/lighting.h"

namespace sansmesh::inline v1 {
namespace {

constexpr Vec3 kWhite{0.95047, 1.0, 1.08883};  // D65

double encoded(double c) { return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055; }

Vec3f shown(const Vec3& light) {
  Vec3f color;
  for (std::size_t k = 0; k < 3; ++k) color[k] = static_cast<float>(encoded(std::clamp(light[k], 0.0, 1.0)));
  return color;
}

double lab_root(double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; }
double lab_cube(double f) { return f > 6.0 / 29 ? f * f * f : (116 * f - 16) * 27 / 24389; }

/// Lightness, saturation and hue of Moreland's polar form of Lab.
Vec3 msh_of_lab(const Vec3& lab) {
  const double m = norm(lab);
  return {m, m > 0 ? std::acos(std::clamp(lab.x / m, -1.0, 1.0)) : 0, std::atan2(lab.z, lab.y)};
}
Vec3 lab_of_msh(const Vec3& msh) {
  return {msh.x * std::cos(msh.y), msh.x * std::sin(msh.y) * std::cos(msh.z),
          msh.x * std::sin(msh.y) * std::sin(msh.z)};
}

/// Hue for an unsaturated colour, so that interpolation to the other colour is uniform.
double unsaturated_hue(const Vec3& saturated, double m) {
  if (saturated.x >= m - 0.1) return saturated.z;
  const double spin =
      saturated.y * std::sqrt(std::max(0.0, m * m - saturated.x * saturated.x)) / (saturated.x * std::sin(saturated.y));
  return saturated.z > -std::numbers::pi / 3 ? saturated.z + spin : saturated.z - spin;
}

Vec3 hsv_of(const Vec3f& c) {
  const double most = static_cast<double>(std::max({c.x, c.y, c.z}));
  const double span = most - static_cast<double>(std::min({c.x, c.y, c.z}));
  if (!(span > 0)) return {0, 0, most};
  const double r = static_cast<double>(c.x), g = static_cast<double>(c.y), b = static_cast<double>(c.z);
  const double hue = most == r ? (g - b) / span : most == g ? 2 + (b - r) / span : 4 + (r - g) / span;
  return {(hue < 0 ? hue + 6 : hue) / 6, span / most, most};
}

}  // namespace

Vec3f srgb_color(const Vec3f& light) {
  Vec3f color;
  for (std::size_t k = 0; k < 3; ++k)
    color[k] = static_cast<float>(encoded(std::max(0.0, static_cast<double>(light[k]))));
  return color;
}

Vec3 lab_of_srgb(const Vec3f& srgb) {
  const Vec3 l(linear_color(srgb));
  const double x = lab_root((0.4124564 * l.x + 0.3575761 * l.y + 0.1804375 * l.z) / kWhite.x);
  const double y = lab_root((0.2126729 * l.x + 0.7151522 * l.y + 0.0721750 * l.z) / kWhite.y);
  const double z = lab_root((0.0193339 * l.x + 0.1191920 * l.y + 0.9503041 * l.z) / kWhite.z);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Vec3f srgb_of_lab(const Vec3& lab) {
  const double fy = (lab.x + 16) / 116;
  const double x = kWhite.x * lab_cube(fy + lab.y / 500), y = kWhite.y * lab_cube(fy);
  const double z = kWhite.z * lab_cube(fy - lab.z / 200);
  return shown({3.2404542 * x - 1.5371385 * y - 0.4985314 * z, -0.9692660 * x + 1.8760108 * y + 0.0415560 * z,
                0.0556434 * x - 0.2040259 * y + 1.0572252 * z});
}

Vec3f srgb_of_oklch(double lightness, double chroma, double hue) {
  const double angle = hue * std::numbers::pi / 180;
  const auto cube = [](double v) { return v * v * v; };
  constexpr double kLess = 0.98;
  for (;; chroma *= kLess) {
    const double a = chroma * std::cos(angle), b = chroma * std::sin(angle);
    const double l = cube(lightness + 0.3963377774 * a + 0.2158037573 * b);
    const double m = cube(lightness - 0.1055613458 * a - 0.0638541728 * b);
    const double s = cube(lightness - 0.0894841775 * a - 1.2914855480 * b);
    const Vec3 light{4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
                     -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
                     -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
    if (chroma < 1e-4 || (std::min({light.x, light.y, light.z}) >= 0 && std::max({light.x, light.y, light.z}) <= 1))
      return shown(light);
  }
}

Vec3f mix_diverging(const Vec3f& first, const Vec3f& second, double t) {
  Vec3 a = msh_of_lab(lab_of_srgb(first)), b = msh_of_lab(lab_of_srgb(second));
  const double turn = std::abs(std::remainder(a.z - b.z, 2 * std::numbers::pi));
  if (a.y > 0.05 && b.y > 0.05 && turn > std::numbers::pi / 3) {
    const double middle = std::max({a.x, b.x, 88.0});
    if (t < 0.5) {
      b = {middle, 0, 0};
      t *= 2;
    } else {
      a = {middle, 0, 0};
      t = 2 * t - 1;
    }
  }
  if (a.y < 0.05 && b.y > 0.05) {
    a.z = unsaturated_hue(b, a.x);
  } else if (b.y < 0.05 && a.y > 0.05) {
    b.z = unsaturated_hue(a, b.x);
  }
  return srgb_of_lab(lab_of_msh(a * (1 - t) + b * t));
}

Vec3f mix_hsv(const Vec3f& first, const Vec3f& second, double t) {
  Vec3 a = hsv_of(first), b = hsv_of(second);
  if (!(a.y > 0)) a.x = b.x;
  if (!(b.y > 0)) b.x = a.x;
  if (a.x - b.x > 0.5) b.x += 1;
  if (b.x - a.x > 0.5) a.x += 1;
  const Vec3 c = a * (1 - t) + b * t;
  const double hue = 6 * (c.x - std::floor(c.x)), chroma = c.y * c.z;
  const double second_part = chroma * (1 - std::abs(std::fmod(hue, 2.0) - 1)), rest = c.z - chroma;
  Vec3 rgb;
  if (hue < 1) {
    rgb = {chroma, second_part, 0};
  } else if (hue < 2) {
    rgb = {second_part, chroma, 0};
  } else if (hue < 3) {
    rgb = {0, chroma, second_part};
  } else if (hue < 4) {
    rgb = {0, second_part, chroma};
  } else if (hue < 5) {
    rgb = {second_part, 0, chroma};
  } else {
    rgb = {chroma, 0, second_part};
  }
  return Vec3f(rgb + Vec3{rest, rest, rest});
}

}  // namespace sansmesh::inline v1
