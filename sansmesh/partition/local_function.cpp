#include "sansmesh/partition/local_function.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sansmesh::inline v1 {
namespace {

/// The slope of a polynomial is evaluated at the centre of its disc and on two rings around it. No point of the disc is
/// farther from all of these than kApart of its radius: the farthest are on the rim between two points of the outer
/// ring, at √(1 + 0.84² − 2 · 0.84 cos 15°) = 0.2878.
struct Ring {
  float radius;  ///< over that of the disc
  int points;
};
constexpr Ring kRings[] = {{0.48f, 6}, {0.84f, 12}};
constexpr float kApart = 0.288f;
/// Bound of the rounding errors in the sums below.
constexpr float kRoundedUp = 1.0001f;

struct Probe {
  float u, v;
};
/// Points of both rings on the unit disc.
std::array<Probe, 18> make_probes() {
  std::array<Probe, 18> probes{};
  std::size_t n = 0;
  for (const Ring& ring : kRings)
    for (int k = 0; k < ring.points; ++k) {
      const float angle = static_cast<float>(k) * 2 * std::numbers::pi_v<float> / static_cast<float>(ring.points);
      probes[n++] = {ring.radius * std::cos(angle), ring.radius * std::sin(angle)};
    }
  return probes;
}

float squared_height_slope(const LocalFunction& f, float u, float v) {
  const HeightGradient g = height_gradient(f, u, v);
  return g.u * g.u + g.v * g.v;
}

/// Bound for the norm of g's second derivatives where u² + v² ≤ r²: the Frobenius norm of bounds of each, with |uv| ≤
/// r²/2.
float height_bend(const LocalFunction& f, float r) {
  const auto c = [&](std::size_t i) { return std::abs(f.coefficient[i]); };
  float uu = 0, uv = 0, vv = 0;
  if (f.degree >= 2) uu = 2 * c(3), uv = c(4), vv = 2 * c(5);
  if (f.degree >= 3)
    uu += r * std::hypot(6 * c(6), 2 * c(7)), uv += r * std::hypot(2 * c(7), 2 * c(8)),
        vv += r * std::hypot(2 * c(8), 6 * c(9));
  if (f.degree >= 4)
    uu += r * r * (std::max(12 * c(10), 2 * c(12)) + 3 * c(11)), uv += r * r * (3 * std::max(c(11), c(13)) + 2 * c(12)),
        vv += r * r * (std::max(2 * c(12), 12 * c(14)) + 3 * c(13));
  return std::sqrt(uu * uu + 2 * uv * uv + vv * vv);
}

}  // namespace

HeightGradient height_gradient(const LocalFunction& f, float u, float v) {
  const auto& c = f.coefficient;
  float gu = 0, gv = 0;
  if (f.degree >= 1) gu = c[1], gv = c[2];
  if (f.degree >= 2) gu += 2 * u * c[3] + v * c[4], gv += u * c[4] + 2 * v * c[5];
  if (f.degree >= 3)
    gu += 3 * u * u * c[6] + 2 * u * v * c[7] + v * v * c[8], gv += u * u * c[7] + 2 * u * v * c[8] + 3 * v * v * c[9];
  if (f.degree >= 4)
    gu += 4 * u * u * u * c[10] + 3 * u * u * v * c[11] + 2 * u * v * v * c[12] + v * v * v * c[13],
        gv += u * u * u * c[11] + 2 * u * u * v * c[12] + 3 * u * v * v * c[13] + 4 * v * v * v * c[14];
  return {gu, gv};
}

float local_value(const LocalFunction& f, const Vec3f& x) {
  const Vec3f d = (x - f.center) / f.scale;
  const float u = dot(d, f.xi), v = dot(d, f.eta), w = dot(d, f.nu);
  const auto& c = f.coefficient;
  float g = c[0];
  if (f.degree >= 1) g += u * c[1] + v * c[2];
  if (f.degree >= 2) g += u * u * c[3] + u * v * c[4] + v * v * c[5];
  if (f.degree >= 3) g += u * u * u * c[6] + u * u * v * c[7] + u * v * v * c[8] + v * v * v * c[9];
  if (f.degree >= 4)
    g += u * u * u * u * c[10] + u * u * u * v * c[11] + u * u * v * v * c[12] + u * v * v * v * c[13] +
         v * v * v * v * c[14];
  return (w - g) * f.scale;
}

float local_slope(const LocalFunction& f, const Vec3f& center, float radius) {
  if (f.is_constant()) return 0;
  const Vec3f d = (center - f.center) / f.scale;
  const float u = dot(d, f.xi), v = dot(d, f.eta), r = radius / f.scale;
  float most = squared_height_slope(f, u, v);
  static const std::array<Probe, 18> probes = make_probes();
  for (const Probe& p : probes) most = std::max(most, squared_height_slope(f, u + r * p.u, v + r * p.v));
  most = std::sqrt(most);
  // Between these points ∇g changes by at most the bound of its derivative.
  most += kApart * r * height_bend(f, std::hypot(u, v) + r);
  return std::hypot(1.0f, most) * kRoundedUp;
}

}  // namespace sansmesh::inline v1
