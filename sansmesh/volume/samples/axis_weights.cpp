#include "sansmesh/volume/samples/axis_weights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sansmesh/core/index_in.h"
#include "sansmesh/volume/cells/axis_interval.h"

namespace sansmesh::inline v1::detail {
namespace {

constexpr int kSincReach = 4;  ///< in steps

}  // namespace

CubicAxis::CubicAxis(std::span<const double> knots, bool uniform, double b, double c)
    : knots_(knots.begin(), knots.end()), value_(knots.size()), slope_(knots.size()) {
  const std::size_t n = knots_.size();
  if (uniform) inverse_step_ = static_cast<double>(n - 1) / (knots_.back() - knots_.front());
  const double steep = b + 2 * c;
  if (n == 2) {
    const double s = 1 / (knots_[1] - knots_[0]);
    value_ = {{1, 0, 0}, {0, 1, 0}};
    slope_.assign(2, {-s * steep, s * steep, 0});
    pieces_ = {piece_of(0)};
    find_most_weights();
    return;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t first = base(i), at = i - first;
    const double h0 = knots_[first + 1] - knots_[first], h1 = knots_[first + 2] - knots_[first + 1], h = h0 + h1;
    // The slope of the parabola at its middle sample, and half its second derivative, the divided difference.
    const std::array<double, 3> middle{-h1 / (h0 * h), (h1 - h0) / (h0 * h1), h0 / (h1 * h)};
    const std::array<double, 3> second{1 / (h0 * h), -1 / (h0 * h1), 1 / (h1 * h)};
    const double t = at == 0 ? -h0 : at == 2 ? h1 : 0;
    for (std::size_t j = 0; j < 3; ++j) {
      slope_[i][j] = steep * (middle[j] + 2 * t * second[j]);
      value_[i][j] = (j == at ? 1 : 0) + (at == 1 ? b / 6 * 2 * h0 * h1 * second[j] : 0);
    }
  }
  pieces_.reserve(n - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) pieces_.push_back(piece_of(i));
  find_most_weights();
}

std::size_t CubicAxis::piece_at(double x) const {
  const std::size_t n = knots_.size();
  if (!(inverse_step_ > 0)) return interval_of(knots_, false, x);
  const double t = (x - knots_[0]) * inverse_step_;
  // Points moved by rounding meet the next piece smoothly.
  return t > 0 ? std::min(static_cast<std::size_t>(t), n - 2) : 0;
}

void CubicAxis::find_most_weights() {
  // On the interval, and beyond the ends: half a step, of cells whose sizes differ at most a whole one. Between the
  // tested places sums are larger by less than a hundredth.
  constexpr int kTests = 16;
  const auto sum_at = [&](double x) {
    AxisWeights w;
    weights(x, w);
    double sum = 0;
    for (std::size_t j = 0; j < w.count; ++j) sum += std::abs(w.value[j]);
    return 1.01 * sum;
  };
  // Equal steps have equal weights, except for those next to the ends.
  const std::size_t n = pieces_.size(), tested = inverse_step_ > 0 ? std::min<std::size_t>(n, 3) : n;
  for (std::size_t k = 0; k < tested; ++k) {
    const std::size_t i = k < 2 || tested == n ? k : n - 1;
    const double h = knots_[i + 1] - knots_[i];
    for (int t = 0; t <= kTests; ++t) most_within_ = std::max(most_within_, sum_at(knots_[i] + h * t / kTests));
  }
  const double beyond = inverse_step_ > 0 ? 0.5 : 1;
  most_beyond_ = std::max({most_within_, sum_at(knots_[0] - beyond * (knots_[1] - knots_[0])),
                           sum_at(knots_.back() + beyond * (knots_.back() - knots_[knots_.size() - 2]))});
}

CubicAxis::Piece CubicAxis::piece_of(std::size_t i) const {
  const std::size_t n = knots_.size(), from = base(i), to = base(i + 1);
  const double h = knots_[i + 1] - knots_[i];
  Piece piece{knots_[i], 1 / h, n > kCount ? std::min(from, n - kCount) : 0, {}};
  // Values and slopes at both ends; three weights from `at` on, which is 0 or 1.
  std::array<double, kCount + 2> a{}, b{}, c{}, d{};
  for (std::size_t j = 0; j < 3; ++j) {
    a[from - piece.first + j] = value_[i][j], c[from - piece.first + j] = h * slope_[i][j];
    b[to - piece.first + j] = value_[i + 1][j], d[to - piece.first + j] = h * slope_[i + 1][j];
  }
  for (std::size_t j = 0; j < kCount; ++j) {
    piece.powers[0][j] = a[j];
    piece.powers[1][j] = c[j];
    piece.powers[2][j] = 3 * (b[j] - a[j]) - 2 * c[j] - d[j];
    piece.powers[3][j] = 2 * (a[j] - b[j]) + c[j] + d[j];
  }
  return piece;
}

void CubicAxis::weights(double x, AxisWeights& out) const {
  const Piece& p = pieces_[piece_at(x)];
  const double u = (x - p.knot) * p.inverse, v = std::clamp(u, 0.0, 1.0), beyond = u - v;
  out.first = p.first;
  out.count = std::min(knots_.size(), kCount);
  for (std::size_t j = 0; j < kCount; ++j) {
    const double c1 = p.powers[1][j], c2 = p.powers[2][j], c3 = p.powers[3][j];
    const double slope = c1 + v * (2 * c2 + v * (3 * c3));
    out.value[j] = p.powers[0][j] + v * (c1 + v * (c2 + v * c3)) + beyond * slope;
    out.slope[j] = slope * p.inverse;
  }
}

SincAxis::SincAxis(std::span<const double> knots)
    : start_(knots.front()),
      step_((knots.back() - knots.front()) / static_cast<double>(knots.size() - 1)),
      count_(knots.size()) {}

void SincAxis::weights(double x, AxisWeights& out) const {
  constexpr double kPi = std::numbers::pi;
  const auto n = static_cast<std::ptrdiff_t>(count_);
  const double at = (x - start_) / step_;
  const auto i = index_in<std::ptrdiff_t>(at, 0, n - 2);
  const std::ptrdiff_t first = std::clamp<std::ptrdiff_t>(i - kSincReach + 1, 0, std::max<std::ptrdiff_t>(0, n - 8));
  out.first = static_cast<std::size_t>(first);
  out.count = static_cast<std::size_t>(std::min<std::ptrdiff_t>(n, 8));
  out.value.fill(0), out.slope.fill(0);
  double value[2 * kSincReach], slope[2 * kSincReach], sum = 0, slopes = 0;
  for (int j = 0; j < 2 * kSincReach; ++j) {
    const double t = at - static_cast<double>(i + j - kSincReach + 1);
    value[j] = slope[j] = 0;
    if (std::abs(t) < kSincReach) {
      const double p = kPi * t, q = p / kSincReach, window = 1 + std::cos(q), small = p * p;
      const double sinc = std::abs(t) < 1e-3 ? 1 - small / 6 * (1 - small / 20) : std::sin(p) / p;
      const double fall = std::abs(t) < 1e-3 ? -kPi * p / 3 * (1 - small / 10) : (std::cos(p) - sinc) / t;
      value[j] = window * sinc;
      slope[j] = window * fall - kPi / kSincReach * std::sin(q) * sinc;
    }
    sum += value[j], slopes += slope[j];
  }
  const auto add = [&](std::ptrdiff_t sample, double v, double s) {
    out.value[static_cast<std::size_t>(sample - first)] += v;
    out.slope[static_cast<std::size_t>(sample - first)] += s;
  };
  for (int j = 0; j < 2 * kSincReach; ++j) {
    const double v = value[j] / sum, s = (slope[j] - v * slopes) / (sum * step_);
    const std::ptrdiff_t sample = i + j - kSincReach + 1;
    const std::ptrdiff_t beyond = sample < 0 ? -sample : sample >= n ? sample - (n - 1) : 0;
    if (beyond == 0) {
      add(sample, v, s);
      continue;
    }
    // f(end + k) = 2 f(end) − f(end − k); without such a sample linear: f(end) + k (f(end) − f(before)).
    const std::ptrdiff_t end = sample < 0 ? 0 : n - 1, inward = sample < 0 ? 1 : -1;
    if (beyond < n) {
      add(end, 2 * v, 2 * s);
      add(end + inward * beyond, -v, -s);
    } else {
      const auto k = static_cast<double>(beyond);
      add(end, (1 + k) * v, (1 + k) * s);
      add(end + inward, -k * v, -k * s);
    }
  }
}

LagrangeAxis::LagrangeAxis(std::span<const double> knots, bool uniform, int degree)
    : knots_(knots.begin(), knots.end()),
      uniform_(uniform),
      degree_(std::min(static_cast<std::size_t>(degree), knots.size() - 1)) {}

void LagrangeAxis::polynomial(std::size_t first, double x, double* value, double* slope) const {
  for (std::size_t j = 0; j <= degree_; ++j) {
    double product = 1, derivative = 0;
    for (std::size_t k = 0; k <= degree_; ++k) {
      if (k == j) continue;
      const double over = 1 / (knots_[first + j] - knots_[first + k]);
      derivative = (derivative * (x - knots_[first + k]) + product) * over;
      product *= (x - knots_[first + k]) * over;
    }
    value[j] = product, slope[j] = derivative;
  }
}

void LagrangeAxis::weights(double x, AxisWeights& out) const {
  const std::size_t n = knots_.size(), i = interval_of(knots_, uniform_, x), most = n - 1 - degree_;
  const auto window = [&](std::size_t before) { return i < before ? 0 : std::min(i - before, most); };
  out.value.fill(0), out.slope.fill(0);
  if (degree_ % 2 == 1) {
    out.first = window(degree_ / 2);
    out.count = degree_ + 1;
    polynomial(out.first, x, out.value.data(), out.slope.data());
    return;
  }
  const std::size_t left = window(degree_ / 2), right = window(degree_ / 2 - 1);
  out.first = left;
  out.count = right - left + degree_ + 1;
  const double h = knots_[i + 1] - knots_[i], u = std::clamp((x - knots_[i]) / h, 0.0, 1.0);
  const double du = x > knots_[i] && x < knots_[i + 1] ? 1 / h : 0;
  double value[kMostAxisWeights], slope[kMostAxisWeights];
  polynomial(left, x, value, slope);
  for (std::size_t j = 0; j <= degree_; ++j) {
    out.value[j] += (1 - u) * value[j];
    out.slope[j] += (1 - u) * slope[j] - du * value[j];
  }
  polynomial(right, x, value, slope);
  for (std::size_t j = 0; j <= degree_; ++j) {
    out.value[right - left + j] += u * value[j];
    out.slope[right - left + j] += u * slope[j] + du * value[j];
  }
}

}  // namespace sansmesh::inline v1::detail
