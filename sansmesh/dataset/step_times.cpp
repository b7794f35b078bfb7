#include "sansmesh/dataset/step_times.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

void check_step_times(std::span<const double> times) {
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!std::isfinite(times[i])) throw ArgumentError(fmt::format("the time of step {} is not known", i));
    if (i > 0 && !(times[i] > times[i - 1]))
      throw ArgumentError(
          fmt::format("the times of the steps must increase: step {} is of {:.9g}, the one before of {:.9g}", i,
                      times[i], times[i - 1]));
  }
}

std::size_t step_interval(std::span<const double> times, double t) {
  const auto after = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), t) - times.begin());
  return std::clamp<std::size_t>(after, 1, times.size() - 1) - 1;
}

}  // namespace sansmesh::inline v1
