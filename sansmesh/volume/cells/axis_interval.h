// Locates a coordinate on an axis.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "sansmesh/core/index_in.h"

namespace sansmesh::inline v1 {

/// Index of the interval between ascending knots (two or more) that contains x; a knot belongs to the interval above
/// it. Values beyond the ends, and NaN, give the first or last interval. `uniform`: knots are equidistant up to
/// rounding.
inline std::size_t interval_of(std::span<const double> knots, bool uniform, double x) {
  const std::size_t last = knots.size() - 2;
  if (!(x > knots[0])) return 0;
  if (x >= knots[last]) return last;
  if (!uniform) return static_cast<std::size_t>(std::upper_bound(knots.begin(), knots.end(), x) - knots.begin()) - 1;
  const double step = (knots.back() - knots.front()) / static_cast<double>(knots.size() - 1);
  std::size_t i = index_in<std::size_t>((x - knots.front()) / step, 0, last);
  while (i > 0 && x < knots[i]) --i;  // the quotient is rounded
  while (i < last && x >= knots[i + 1]) ++i;
  return i;
}

}  // namespace sansmesh::inline v1
