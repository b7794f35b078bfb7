#include "sansmesh/core/dyadic.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace sansmesh::inline v1 {
namespace {

__extension__ using DoubleDigit = unsigned __int128;

/// a ≥ b, for digits of equal length.
bool at_least(const std::vector<std::uint64_t>& a, const std::vector<std::uint64_t>& b) {
  for (std::size_t i = a.size(); i-- > 0;)
    if (a[i] != b[i]) return a[i] > b[i];
  return true;
}

}  // namespace

Dyadic::Dyadic(double exact) {
  if (exact == 0) return;
  int exponent = 0;
  const double mantissa = std::frexp(std::abs(exact), &exponent);
  const auto whole = static_cast<std::uint64_t>(std::ldexp(mantissa, 53));
  exponent -= 53;
  const int shift = ((exponent % 64) + 64) % 64;
  const DoubleDigit both = static_cast<DoubleDigit>(whole) << shift;
  sign_ = exact < 0 ? -1 : 1;
  power_ = (exponent - shift) / 64;
  digits_ = {static_cast<std::uint64_t>(both), static_cast<std::uint64_t>(both >> 64)};
  trim();
}

void Dyadic::trim() {
  while (!digits_.empty() && digits_.back() == 0) digits_.pop_back();
  std::size_t zeros = 0;
  while (zeros < digits_.size() && digits_[zeros] == 0) ++zeros;
  digits_.erase(digits_.begin(), digits_.begin() + static_cast<std::ptrdiff_t>(zeros));
  power_ += static_cast<int>(zeros);
  if (digits_.empty()) sign_ = 0, power_ = 0;
}

Dyadic Dyadic::sum(const Dyadic& a, const Dyadic& b, int sign_of_b) {
  if (sign_of_b == 0) return a;
  if (a.sign_ == 0) {
    Dyadic result = b;
    result.sign_ = sign_of_b;
    return result;
  }
  const int power = std::min(a.power_, b.power_);
  const int end =
      std::max(a.power_ + static_cast<int>(a.digits_.size()), b.power_ + static_cast<int>(b.digits_.size()));
  const auto aligned = [&](const Dyadic& x) {
    std::vector<std::uint64_t> digits(static_cast<std::size_t>(end - power) + 1);
    std::copy(x.digits_.begin(), x.digits_.end(), digits.begin() + (x.power_ - power));
    return digits;
  };
  std::vector<std::uint64_t> left = aligned(a), right = aligned(b);
  Dyadic result;
  result.power_ = power;
  if (a.sign_ == sign_of_b) {
    DoubleDigit carry = 0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      carry += static_cast<DoubleDigit>(left[i]) + right[i];
      left[i] = static_cast<std::uint64_t>(carry);
      carry >>= 64;
    }
    result.sign_ = a.sign_;
  } else {
    result.sign_ = a.sign_;
    if (!at_least(left, right)) std::swap(left, right), result.sign_ = sign_of_b;
    std::uint64_t borrow = 0;
    for (std::size_t i = 0; i < left.size(); ++i) {
      const std::uint64_t taken = right[i] + borrow;
      const bool wrapped = taken < borrow;
      borrow = wrapped || left[i] < taken ? 1 : 0;
      left[i] -= taken;
    }
  }
  result.digits_ = std::move(left);
  result.trim();
  return result;
}

Dyadic Dyadic::product(const Dyadic& a, const Dyadic& b) {
  Dyadic result;
  if (a.sign_ == 0 || b.sign_ == 0) return result;
  result.sign_ = a.sign_ * b.sign_;
  result.power_ = a.power_ + b.power_;
  result.digits_.assign(a.digits_.size() + b.digits_.size(), 0);
  for (std::size_t i = 0; i < a.digits_.size(); ++i) {
    DoubleDigit carry = 0;
    for (std::size_t j = 0; j < b.digits_.size(); ++j) {
      carry += static_cast<DoubleDigit>(a.digits_[i]) * b.digits_[j] + result.digits_[i + j];
      result.digits_[i + j] = static_cast<std::uint64_t>(carry);
      carry >>= 64;
    }
    result.digits_[i + b.digits_.size()] = static_cast<std::uint64_t>(carry);
  }
  result.trim();
  return result;
}

double Dyadic::leading(int& power) const {
  const std::size_t n = digits_.size();
  double value = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(n, 3); ++i)
    value += std::ldexp(static_cast<double>(digits_[n - 1 - i]), -64 * static_cast<int>(i));
  power = power_ + static_cast<int>(n) - 1;
  return value;
}

double Dyadic::ratio(const Dyadic& a, const Dyadic& b) {
  if (a.sign_ == 0) return 0;
  int up = 0, down = 0;
  const double above = a.leading(up), below = b.leading(down);
  return a.sign_ * b.sign_ * std::ldexp(above / below, 64 * (up - down));
}

}  // namespace sansmesh::inline v1
