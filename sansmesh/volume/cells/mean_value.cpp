#include "sansmesh/volume/cells/mean_value.h"

#include <algorithm>
#include <cmath>

namespace sansmesh::inline v1::detail {
namespace {

constexpr double kMeanValueFlat = 1e-7;   ///< |det| of unit vectors below which x is in a triangle's plane
constexpr double kMeanValueClose = 1e-5;  ///< the same, below which its derivatives lose too many digits
constexpr std::size_t kMostCorners = 8;

/// A number and its gradient.
struct Dual {
  double v = 0;
  Vec3 d;
  Dual() = default;
  Dual(double value) : v(value) {}  // NOLINT(google-explicit-constructor): constants are numbers without a gradient
  Dual(double value, const Vec3& gradient) : v(value), d(gradient) {}
  friend Dual operator+(const Dual& a, const Dual& b) { return {a.v + b.v, a.d + b.d}; }
  friend Dual operator-(const Dual& a, const Dual& b) { return {a.v - b.v, a.d - b.d}; }
  friend Dual operator*(const Dual& a, const Dual& b) { return {a.v * b.v, a.d * b.v + b.d * a.v}; }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const double q = a.v / b.v;
    return {q, (a.d - b.d * q) / b.v};
  }
  Dual& operator+=(const Dual& o) { return v += o.v, d += o.d, *this; }
};
double value_of(double a) { return a; }
double value_of(const Dual& a) { return a.v; }
double root(double a) { return std::sqrt(a); }
Dual root(const Dual& a) {
  const double r = std::sqrt(a.v);
  return {r, a.d * (0.5 / r)};
}
double angle(double sine, double cosine) { return std::atan2(sine, cosine); }
Dual angle(const Dual& s, const Dual& c) {
  return {std::atan2(s.v, c.v), (s.d * c.v - c.d * s.v) / (s.v * s.v + c.v * c.v)};
}

template <class T>
struct Triple {
  T x, y, z;
  friend Triple operator*(const Triple& a, const T& s) { return {a.x * s, a.y * s, a.z * s}; }
  Triple& operator+=(const Triple& o) { return x += o.x, y += o.y, z += o.z, *this; }
};
template <class T>
T inner(const Triple<T>& a, const Triple<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
Triple<T> outer(const Triple<T>& a, const Triple<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
void offset_from(const Vec3& p, const Vec3& x, Triple<double>& out) { out = {p.x - x.x, p.y - x.y, p.z - x.z}; }
void offset_from(const Vec3& p, const Vec3& x, Triple<Dual>& out) {
  out = {Dual(p.x - x.x, {-1, 0, 0}), Dual(p.y - x.y, {0, -1, 0}), Dual(p.z - x.z, {0, 0, -1})};
}

/// Barycentric coordinates on a triangle of the projection of x to its plane.
std::array<double, 3> triangle_weights(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& x) {
  const Vec3 n = cross(b - a, c - a);
  const double over = 1 / squared_norm(n);
  const double wb = dot(cross(x - a, c - a), n) * over, wc = dot(cross(b - a, x - a), n) * over;
  return {1 - wb - wc, wb, wc};
}

/// The vector integral of directions over the spherical projection of a triangle seen from x is a sum over its corners'
/// directions u_i: Σ μ_i u_i. Over all triangles it vanishes, so the weights are Σ μ_i / ‖p_i − x‖. Returns the
/// smallest |det(u_1, u_2, u_3)|; `on` receives the index of the triangle that contains x, if any.
template <class T>
double sum_triangles(std::span<const Vec3> corners, std::span<const std::array<std::uint8_t, 3>> triangles,
                     const Vec3& x, std::span<T> weights, std::size_t& on) {
  std::array<Triple<T>, kMostCorners> u;
  std::array<T, kMostCorners> over;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    Triple<T> d;
    offset_from(corners[c], x, d);
    over[c] = T(1) / root(inner(d, d));
    u[c] = d * over[c];
    weights[c] = T(0);
  }
  double least = 1;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& [i, j, k] = triangles[t];
    std::array<Triple<T>, 3> normal{outer(u[j], u[k]), outer(u[k], u[i]), outer(u[i], u[j])};
    const T det = inner(u[i], normal[0]);
    least = std::min(least, std::abs(value_of(det)));
    if (!(std::abs(value_of(det)) > kMeanValueFlat)) {
      const auto w = triangle_weights(corners[i], corners[j], corners[k], x);
      if (std::min({w[0], w[1], w[2]}) >= -1e-9) on = t;
      continue;  // edge-on, the projection is empty
    }
    const std::array<std::size_t, 3> a{j, k, i}, b{k, i, j};
    Triple<T> m{T(0), T(0), T(0)};
    for (std::size_t e = 0; e < 3; ++e) {
      const T sine = root(inner(normal[e], normal[e]));
      m += normal[e] * (angle(sine, inner(u[a[e]], u[b[e]])) / (T(2) * sine));
    }
    const std::array<std::size_t, 3> corner{i, j, k};
    for (std::size_t e = 0; e < 3; ++e) weights[corner[e]] += inner(m, normal[e]) / det * over[corner[e]];
  }
  return least;
}

}  // namespace

void mean_value_weights(std::span<const Vec3> corners, std::span<const std::array<std::uint8_t, 3>> triangles,
                        const Vec3& x, std::span<double> weights, std::span<Vec3> slopes) {
  Vec3 middle;
  double size = 0;
  for (const Vec3& p : corners) middle += p / static_cast<double>(corners.size());
  for (const Vec3& p : corners) size = std::max(size, norm(p - middle));
  std::fill(weights.begin(), weights.end(), 0);
  const auto corner = std::find_if(corners.begin(), corners.end(),
                                   [&](const Vec3& p) { return squared_norm(p - x) <= 1e-18 * size * size; });
  if (corner != corners.end()) {
    weights[static_cast<std::size_t>(corner - corners.begin())] = 1;
  } else {
    std::size_t on = triangles.size();
    sum_triangles<double>(corners, triangles, x, weights, on);
    double sum = 0;
    for (const double w : weights) sum += w;
    if (on < triangles.size() || !(std::abs(sum) > 0)) {
      if (on == triangles.size()) on = 0;
      const auto& t = triangles[on];
      const auto w = triangle_weights(corners[t[0]], corners[t[1]], corners[t[2]], x);
      std::fill(weights.begin(), weights.end(), 0);
      for (std::size_t k = 0; k < 3; ++k) weights[t[k]] = w[k];
    } else {
      for (double& w : weights) w /= sum;
    }
  }
  if (slopes.empty()) return;
  std::array<Dual, kMostCorners> duals;
  const std::span<Dual> dual(duals.data(), corners.size());
  constexpr double kInwards[] = {0, 1e-4, 1e-3, 1e-2, 1e-1};
  for (const double part : kInwards) {
    const Vec3 p = x + (middle - x) * part;
    if (std::any_of(corners.begin(), corners.end(), [&](const Vec3& c) { return norm(c - p) < 1e-6 * size; })) continue;
    std::size_t on = triangles.size();
    if (sum_triangles<Dual>(corners, triangles, p, dual, on) > kMeanValueClose) break;
  }
  Dual sum;
  for (const Dual& w : dual) sum += w;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    slopes[c] = (dual[c] / sum).d;
    if (!is_finite(slopes[c])) slopes[c] = {};
  }
}

}  // namespace sansmesh::inline v1::detail
