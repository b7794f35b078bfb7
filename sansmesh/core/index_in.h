// From real numbers to whole ones, whatever the real ones are.
#pragma once

#include <limits>
#include <type_traits>

namespace sansmesh::inline v1 {

/// The whole part of `x` (what is behind the point is dropped) as a number from `first` to `last`, first <= last:
/// beyond them the nearer one, of NaN the first. A plain cast of a number that the type cannot hold is undefined, and
/// processors differ in what they make of it. Costs a maximum and a minimum more than the cast, no branch, where
/// doubles hold every number of the type.
template <class Whole, class Real>
constexpr Whole index_in(Real x, std::type_identity_t<Whole> first, std::type_identity_t<Whole> last) {
  static_assert(std::is_integral_v<Whole> && std::is_floating_point_v<Real>);
  constexpr int bits = std::numeric_limits<Whole>::digits;
  // Of the comparisons with NaN none is true.
  if constexpr (bits <= std::numeric_limits<Real>::digits) {
    const Real low = static_cast<Real>(first), high = static_cast<Real>(last);
    x = x > low ? x : low;
    return static_cast<Whole>(x < high ? x : high);
  } else if constexpr (bits <= std::numeric_limits<double>::digits) {
    return index_in<Whole>(static_cast<double>(x), first, last);
  } else {
    // The ends may have been rounded, but between them lie only numbers of the range.
    if (!(x > static_cast<Real>(first))) return first;
    return x < static_cast<Real>(last) ? static_cast<Whole>(x) : last;
  }
}

/// The whole part of `x` as the number of that type that is nearest to it, 0 of NaN.
template <class Whole, class Real>
constexpr Whole whole_part(Real x) {
  using Limits = std::numeric_limits<Whole>;
  return x < 0 ? index_in<Whole>(x, Limits::min(), 0) : index_in<Whole>(x, 0, Limits::max());
}

}  // namespace sansmesh::inline v1
