// Double arithmetic with error bounds: the filter before exact predicates.
#pragma once

#include <cmath>
#include <limits>

namespace sansmesh::inline v1 {

/// A real number within `error` of `value`. Sums, differences, products and quotients bound their rounding errors.
/// Values must stay below 1e150 in magnitude; an infinite error means that nothing is known.
struct Bounded {
  double value = 0, error = 0;

  Bounded() = default;
  /// An exact number.
  Bounded(double exact) : value(exact) {}  // NOLINT(google-explicit-constructor): formulas mix both
  Bounded(double v, double e) : value(v), error(e) {}

  /// 1 or −1, or 0 if the sign is not known.
  int sign() const { return value > error ? 1 : value < -error ? -1 : 0; }

  Bounded& operator+=(const Bounded& b) { return *this = rounded(value + b.value, error + b.error); }
  Bounded& operator-=(const Bounded& b) { return *this = rounded(value - b.value, error + b.error); }
  Bounded& operator*=(const Bounded& b) {
    return *this = rounded(value * b.value, std::abs(value) * b.error + std::abs(b.value) * error + error * b.error);
  }
  friend Bounded operator+(Bounded a, const Bounded& b) { return a += b; }
  friend Bounded operator-(Bounded a, const Bounded& b) { return a -= b; }
  friend Bounded operator*(Bounded a, const Bounded& b) { return a *= b; }
  friend Bounded operator-(const Bounded& a) { return {-a.value, a.error}; }
  friend Bounded operator/(const Bounded& a, const Bounded& b) {
    const double least = std::abs(b.value) - b.error;
    if (!(least > 0)) return {0, std::numeric_limits<double>::infinity()};
    const double q = a.value / b.value;
    return rounded(q, (a.error + std::abs(q) * b.error) / least);
  }

 private:
  /// `value` with the error of one rounding added to those of the operands, and room for the rounding of errors.
  static Bounded rounded(double value, double error) {
    constexpr double kUnit = 2.3e-16, kRoom = 1 + 1e-14, kUnderflow = 1e-300;
    return {value, (error + std::abs(value) * kUnit) * kRoom + kUnderflow};
  }
};

}  // namespace sansmesh::inline v1
