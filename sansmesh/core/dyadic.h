// Exact arithmetic on integers times powers of two.
#pragma once

#include <cstdint>
#include <vector>

namespace sansmesh::inline v1 {

/// An exact number m · 2^e with an integer m of any length: every double, and all sums, differences and products of
/// such numbers.
class Dyadic {
 public:
  Dyadic() = default;
  Dyadic(double exact);  // NOLINT(google-explicit-constructor): formulas mix both

  /// −1, 0 or 1.
  int sign() const { return sign_; }
  /// a / b, rounded to nearly full precision; b is not zero.
  static double ratio(const Dyadic& a, const Dyadic& b);

  Dyadic& operator+=(const Dyadic& b) { return *this = sum(*this, b, b.sign_); }
  Dyadic& operator-=(const Dyadic& b) { return *this = sum(*this, b, -b.sign_); }
  Dyadic& operator*=(const Dyadic& b) { return *this = product(*this, b); }
  friend Dyadic operator+(const Dyadic& a, const Dyadic& b) { return sum(a, b, b.sign_); }
  friend Dyadic operator-(const Dyadic& a, const Dyadic& b) { return sum(a, b, -b.sign_); }
  friend Dyadic operator*(const Dyadic& a, const Dyadic& b) { return product(a, b); }
  friend Dyadic operator-(Dyadic a) { return a.sign_ = -a.sign_, a; }

 private:
  static Dyadic sum(const Dyadic& a, const Dyadic& b, int sign_of_b);
  static Dyadic product(const Dyadic& a, const Dyadic& b);
  void trim();
  /// The leading digits as a double in [1, 2^64), and the power of 2^64 by which they are multiplied.
  double leading(int& power) const;

  int sign_ = 0;
  int power_ = 0;                      ///< power of 2^64 by which the digits are multiplied
  std::vector<std::uint64_t> digits_;  ///< base 2^64, least first, without zeros at the ends
};

}  // namespace sansmesh::inline v1
