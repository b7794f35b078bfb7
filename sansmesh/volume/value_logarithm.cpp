#include "sansmesh/volume/value_logarithm.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "sansmesh/core/parallel.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr std::size_t kComparedSamples = 4000;
constexpr double kLeastDecades = 2;
/// Deviations from means count up to one decade, so that no few samples decide.
constexpr double kMostDeviation = 2.302585092994046;

bool all_positive(const VolumeValues& values) {
  return std::all_of(values.values.begin(), values.values.end(), [](double v) { return v > 0; });
}

/// The logarithm of the ratio of two order statistics, a hundredth from both ends.
double log_spread(std::vector<double> values) {
  const std::size_t low = values.size() / 100, high = values.size() - 1 - low;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(low), values.end());
  const double least = values[low];
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(high), values.end());
  return std::log(values[high]) - std::log(least);
}

}  // namespace

LogarithmChoice choose_logarithm(const SampledVolume& volume, const VolumeValues& values) {
  LogarithmChoice choice;
  if (values.components != 1 || values.values.empty() || !all_positive(values)) return choice;
  choice.decades = log_spread(values.values) / std::log(10.0);
  if (!(choice.decades >= kLeastDecades)) return choice;
  const std::size_t n = volume.size(), count = std::min(n, kComparedSamples);
  std::vector<double> gains(count, 0.0);
  parallel_ranges(0, count, 64, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> star;
    for (std::size_t s = begin; s < end; ++s) {
      const std::size_t i = s * n / count;
      volume.star(i, star);
      if (star.empty()) continue;
      double unit = 0, arithmetic = 0, geometric = 0;
      for (const std::uint32_t j : star) unit = std::max(unit, values.values[j]);
      for (const std::uint32_t j : star) {
        arithmetic += values.values[j] / unit / static_cast<double>(star.size());
        geometric += std::log(values.values[j] / unit) / static_cast<double>(star.size());
      }
      const double own = std::log(values.values[i] / unit);
      gains[s] = std::min(std::abs(std::log(arithmetic) - own), kMostDeviation) -
                 std::min(std::abs(geometric - own), kMostDeviation);
    }
  });
  double gain = 0;
  for (const double g : gains) gain += g;
  choice.use = gain > 0;
  return choice;
}

VolumeValues logarithm_of(VolumeValues values, double unit) {
  if (!all_positive(values))
    throw DataError(fmt::format("array '{}': not all values are positive, so they have no logarithm (`logarithm`)",
                                printable(values.name, 60)));
  parallel_for(0, values.values.size(), 1 << 12,
               [&](std::size_t i) { values.values[i] = std::log(values.values[i] / unit); });
  return values;
}

double logarithm_unit(const VolumeValues& values) {
  const double largest = largest_value(values);
  return largest > 0 ? std::ldexp(1.0, std::ilogb(largest)) : 1;
}

}  // namespace sansmesh::inline v1
