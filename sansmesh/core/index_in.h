// Saturating conversion of real numbers to integers.
#pragma once

#include <limits>
#include <type_traits>

namespace sansmesh::inline v1 {

/// Truncates `x` and clamps it to first..last, first <= last; NaN gives `first`. A plain cast of a number outside the
/// type's range is undefined, and its result differs between processors. Where Real represents every value of the type,
/// the cost is one maximum, one minimum and no branch more than the cast.
template <class Whole, class Real>
constexpr Whole index_in(Real x, std::type_identity_t<Whole> first, std::type_identity_t<Whole> last) {
  static_assert(std::is_integral_v<Whole> && std::is_floating_point_v<Real>);
  constexpr int bits = std::numeric_limits<Whole>::digits;
  // Comparisons with NaN are false, so NaN becomes `low`.
  if constexpr (bits <= std::numeric_limits<Real>::digits) {
    const Real low = static_cast<Real>(first), high = static_cast<Real>(last);
    x = x > low ? x : low;
    return static_cast<Whole>(x < high ? x : high);
  } else if constexpr (bits <= std::numeric_limits<double>::digits) {
    return index_in<Whole>(static_cast<double>(x), first, last);
  } else {
    // Rounding may have moved the bounds, but every value between them is in range.
    if (!(x > static_cast<Real>(first))) return first;
    return x < static_cast<Real>(last) ? static_cast<Whole>(x) : last;
  }
}

/// Truncates `x` and clamps it to the range of the type; NaN gives 0.
template <class Whole, class Real>
constexpr Whole whole_part(Real x) {
  using Limits = std::numeric_limits<Whole>;
  return x < 0 ? index_in<Whole>(x, Limits::min(), 0) : index_in<Whole>(x, 0, Limits::max());
}

}  // namespace sansmesh::inline v1
