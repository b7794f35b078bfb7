// Axis-aligned boxes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Closed axis-aligned box; empty (lower > upper) until a point is added.
template <class T>
struct BoxT {
  /// Corner with the least coordinates.
  VecT<T> lower{std::numeric_limits<T>::max(), std::numeric_limits<T>::max(), std::numeric_limits<T>::max()};
  /// Corner with the largest coordinates.
  VecT<T> upper{std::numeric_limits<T>::lowest(), std::numeric_limits<T>::lowest(), std::numeric_limits<T>::lowest()};

  /// Whether the box contains no point: lower > upper on some axis, or NaN.
  bool empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }
  /// Centre (lower + upper) / 2. Undefined for an empty box.
  VecT<T> center() const { return (lower + upper) * T(0.5); }
  /// Edge lengths upper − lower. Undefined for an empty box.
  VecT<T> size() const { return upper - lower; }
  /// Length of the diagonal; 0 for an empty box.
  T diagonal() const { return empty() ? T(0) : norm(size()); }
  /// Grows the box to contain p.
  void extend(const VecT<T>& p) {
    for (std::size_t k = 0; k < 3; ++k) {
      lower[k] = std::min(lower[k], p[k]);
      upper[k] = std::max(upper[k], p[k]);
    }
  }
  /// Grows the box to contain o; an empty `o` changes nothing.
  void extend(const BoxT& o) {
    if (!o.empty()) extend(o.lower), extend(o.upper);
  }
  /// Whether p is in the box, including its faces.
  bool contains(const VecT<T>& p) const {
    return p.x >= lower.x && p.x <= upper.x && p.y >= lower.y && p.y <= upper.y && p.z >= lower.z && p.z <= upper.z;
  }
};

/// Box in double: world coordinates.
using Box3 = BoxT<double>;
/// Box in float: positions relative to an origin.
using Box3f = BoxT<float>;

}  // namespace sansmesh::inline v1
