#include "sansmesh/surface/levin_plane.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sansmesh/surface/sample_group.h"

namespace sansmesh::inline v1::detail {
namespace {

constexpr int kMostSteps = 200;
constexpr double kLongestStep = 0.3;  // in widths, or in radians
constexpr double kFlat = 1e-10;       // derivatives over the sum of the weights, lengths in widths
constexpr double kRounding = 1e-14;   // rounding error of energies
constexpr double kSufficient = 1e-4;  // least share of the descent that the slope predicts (Armijo)

using Three = std::array<double, 3>;

double inner(const Three& a, const Three& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Energy over (a, b, t/h) with n = (n₀ + a e + b f) / ‖·‖: a chart of the hemisphere.
struct Chart {
  std::span<const WeighedSample> samples;
  Vec3 r, n, e, f;
  double width, scale;  // scale: makes lengths widths and the sum of the weights about 1

  LevinPlane plane(const Three& p) const { return {normalized(n + e * p[0] + f * p[1]), p[2] * width, 0}; }

  double operator()(const Three& p, Three& gradient) const {
    const double length = std::sqrt(1 + p[0] * p[0] + p[1] * p[1]);
    Vec3 by_normal;
    double by_offset = 0;
    const double energy = levin_energy(samples, r, plane(p), &by_normal, &by_offset);
    gradient = {scale * dot(by_normal, e) / length, scale * dot(by_normal, f) / length, scale * by_offset * width};
    return scale * energy;
  }
};

}  // namespace

double WeighedSample::weight(double square, double* slope) const {
  if (gaussian) {
    const double exponent = square * inverse_width;
    const double w = exponent < double{kGaussianEnd} ? factor * std::exp(-exponent) : 0;
    if (slope) *slope = -inverse_width * w;
    return w;
  }
  const double t = std::max(0.0, 1 - square * inverse_width);
  if (slope) *slope = -4 * inverse_width * factor * t * t * t;
  return factor * t * t * t * t;
}

double levin_energy(std::span<const WeighedSample> samples, const Vec3& r, const LevinPlane& plane, Vec3* by_normal,
                    double* by_offset) {
  const Vec3 q = r + plane.normal * plane.offset;
  double energy = 0, offset = 0;
  Vec3 normal;
  for (const WeighedSample& s : samples) {
    const Vec3 d = s.x - q;
    const double z = dot(plane.normal, d);
    double slope = 0;
    const double w = s.weight(squared_norm(d), &slope);
    energy += w * z * z;
    // Derivative of ⟨n, d⟩ with respect to n along the sphere: d; of ‖d‖²: −2 t d. With respect to t: −1 and −2 z.
    normal += d * (2 * z * w - 2 * plane.offset * z * z * slope);
    offset -= 2 * z * w + 2 * z * z * z * slope;
  }
  if (by_normal) *by_normal = normal - plane.normal * dot(normal, plane.normal);
  if (by_offset) *by_offset = offset;
  return energy;
}

LevinPlane least_levin_plane(std::span<const WeighedSample> samples, const Vec3& r, const LevinPlane& start,
                             double width) {
  Chart chart{samples, r, start.normal, {}, {}, width, 1};
  tangent_frame(start.normal, chart.e, chart.f);
  double weights = 0;
  const Vec3 q = r + start.normal * start.offset;
  for (const WeighedSample& s : samples) weights += s.weight(squared_norm(s.x - q));
  if (!(weights > 0)) return start;
  chart.scale = 1 / (weights * width * width);

  Three p{0, 0, start.offset / width}, gradient{};
  double energy = chart(p, gradient);
  // Estimated inverse of the second derivatives; initially ½, the value for weights that sum to 1.
  std::array<Three, 3> inverse{Three{0.5, 0, 0}, Three{0, 0.5, 0}, Three{0, 0, 0.5}};
  int steps = 0;
  for (; steps < kMostSteps && inner(gradient, gradient) > kFlat * kFlat; ++steps) {
    Three step{};
    for (std::size_t i = 0; i < 3; ++i) step[i] = -inner(inverse[i], gradient);
    double slope = inner(step, gradient);
    if (!(slope < 0)) {  // rounding has spoilt the model: restart with the steepest descent
      inverse = {Three{0.5, 0, 0}, Three{0, 0.5, 0}, Three{0, 0, 0.5}};
      for (std::size_t i = 0; i < 3; ++i) step[i] = -0.5 * gradient[i];
      slope = inner(step, gradient);
    }
    const double length = std::sqrt(inner(step, step));
    double share = std::min(1.0, kLongestStep / length);
    Three next{}, next_gradient{};
    double next_energy = 0;
    bool lower = false;
    for (int halving = 0; halving < 20 && !lower; ++halving, share *= 0.5) {
      for (std::size_t i = 0; i < 3; ++i) next[i] = p[i] + share * step[i];
      next_energy = chart(next, next_gradient);
      // Where energies are equal to rounding, the derivatives decide.
      const bool level =
          next_energy <= energy * (1 + kRounding) && inner(next_gradient, next_gradient) < inner(gradient, gradient);
      lower = level || next_energy <= energy + kSufficient * share * slope;
    }
    if (!lower) break;
    Three moved{}, turned{};
    for (std::size_t i = 0; i < 3; ++i) moved[i] = next[i] - p[i], turned[i] = next_gradient[i] - gradient[i];
    p = next, energy = next_energy, gradient = next_gradient;
    const double curvature = inner(moved, turned);
    if (!(curvature > 1e-12 * inner(moved, moved))) continue;
    // (I − s yᵀ/⟨s,y⟩) H (I − y sᵀ/⟨s,y⟩) + s sᵀ/⟨s,y⟩
    Three turned_by{};
    for (std::size_t i = 0; i < 3; ++i) turned_by[i] = inner(inverse[i], turned);
    const double quotient = inner(turned, turned_by);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        inverse[i][k] += (1 + quotient / curvature) * moved[i] * moved[k] / curvature -
                         (turned_by[i] * moved[k] + moved[i] * turned_by[k]) / curvature;
  }
  LevinPlane best = chart.plane(p);
  best.steps = steps;
  return best;
}

}  // namespace sansmesh::inline v1::detail
