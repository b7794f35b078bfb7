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
  VecT<T> lower{std::numeric_limits<T>::max(), std::numeric_limits<T>::max(), std::numeric_limits<T>::max()};
  VecT<T> upper{std::numeric_limits<T>::lowest(), std::numeric_limits<T>::lowest(), std::numeric_limits<T>::lowest()};

  bool empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }
  VecT<T> center() const { return (lower + upper) * T(0.5); }
  VecT<T> size() const { return upper - lower; }
  /// Length of the diagonal; 0 for an empty box.
  T diagonal() const { return empty() ? T(0) : norm(size()); }
  void extend(const VecT<T>& p) {
    for (std::size_t k = 0; k < 3; ++k) {
      lower[k] = std::min(lower[k], p[k]);
      upper[k] = std::max(upper[k], p[k]);
    }
  }
  void extend(const BoxT& o) {
    if (!o.empty()) extend(o.lower), extend(o.upper);
  }
  bool contains(const VecT<T>& p) const {
    return p.x >= lower.x && p.x <= upper.x && p.y >= lower.y && p.y <= upper.y && p.z >= lower.z && p.z <= upper.z;
  }
};

using Box3 = BoxT<double>;
using Box3f = BoxT<float>;

}  // namespace sansmesh::inline v1
