// Residues modulo the prime 2^61 − 1: numbers as fingerprints of exact values.
#pragma once

#include <bit>
#include <compare>
#include <cstdint>

namespace sansmesh::inline v1 {

/// A rational number modulo p = 2^61 − 1. Doubles are fractions with powers of two below, so every formula of sums,
/// products and quotients of doubles has an exact residue. Equal values have equal residues. Different values have
/// equal ones with a probability of about 2^-61: a residue of zero is taken as proof of zero.
class Residue {
 public:
  Residue() = default;
  /// `exact` is finite.
  Residue(double exact) {  // NOLINT(google-explicit-constructor): formulas mix both
    const auto bits = std::bit_cast<std::uint64_t>(exact);
    const auto field = static_cast<std::uint32_t>(bits >> 52 & 0x7ff);
    const std::uint64_t fraction = bits & ((std::uint64_t{1} << 52) - 1);
    const std::uint64_t magnitude = field != 0 ? fraction | std::uint64_t{1} << 52 : fraction;
    // The last digit is worth 2^(field − 1075), and 2^61 ≡ 1: 1098 = 18 · 61.
    const std::uint32_t turn = ((field != 0 ? field : 1) + 1098 - 1075) % 61;
    const std::uint64_t v = folded(static_cast<Wide>(magnitude) << turn);
    v_ = bits >> 63 != 0 && v != 0 ? kPrime - v : v;
  }

  bool zero() const { return v_ == 0; }
  std::uint64_t bits() const { return v_; }
  friend auto operator<=>(const Residue&, const Residue&) = default;

  Residue& operator+=(const Residue& b) {
    v_ += b.v_;
    if (v_ >= kPrime) v_ -= kPrime;
    return *this;
  }
  Residue& operator-=(const Residue& b) {
    v_ = v_ >= b.v_ ? v_ - b.v_ : v_ + kPrime - b.v_;
    return *this;
  }
  Residue& operator*=(const Residue& b) {
    v_ = folded(static_cast<Wide>(v_) * b.v_);
    return *this;
  }
  friend Residue operator+(Residue a, const Residue& b) { return a += b; }
  friend Residue operator-(Residue a, const Residue& b) { return a -= b; }
  friend Residue operator*(Residue a, const Residue& b) { return a *= b; }
  friend Residue operator-(const Residue& a) { return Residue() - a; }
  /// `b` is not zero.
  friend Residue operator/(const Residue& a, const Residue& b) { return a * b.inverse(); }

 private:
  __extension__ using Wide = unsigned __int128;
  static constexpr std::uint64_t kPrime = (std::uint64_t{1} << 61) - 1;

  static std::uint64_t folded(Wide x) {
    std::uint64_t v = static_cast<std::uint64_t>(x & kPrime) + static_cast<std::uint64_t>(x >> 61);
    v = (v & kPrime) + (v >> 61);
    return v >= kPrime ? v - kPrime : v;
  }
  /// By Euclid's algorithm.
  Residue inverse() const {
    std::int64_t t = 0, next_t = 1;
    std::uint64_t r = kPrime, next_r = v_;
    while (next_r != 0) {
      const std::uint64_t q = r / next_r;
      const std::int64_t t2 = t - static_cast<std::int64_t>(q) * next_t;
      t = next_t, next_t = t2;
      const std::uint64_t r2 = r - q * next_r;
      r = next_r, next_r = r2;
    }
    Residue result;
    result.v_ = t < 0 ? kPrime - static_cast<std::uint64_t>(-t) : static_cast<std::uint64_t>(t);
    return result;
  }

  std::uint64_t v_ = 0;
};

}  // namespace sansmesh::inline v1
