#include "sansmesh/points/sampling/subsample.h"

#include <algorithm>
#include <numeric>

#include "sansmesh/core/scramble.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

std::vector<std::uint32_t> scattered_choice(std::size_t n, std::size_t count) {
  std::vector<std::uint32_t> chosen;
  if (count >= n) {
    chosen.resize(n);
    std::iota(chosen.begin(), chosen.end(), 0u);
    return chosen;
  }
  // Selection sampling: takes each number with the probability of required over remaining ones.
  chosen.reserve(count);
  for (std::size_t i = 0; i < n && chosen.size() < count; ++i)
    if (scrambled(i) % (n - i) < count - chosen.size()) chosen.push_back(static_cast<std::uint32_t>(i));
  return chosen;
}

std::vector<std::uint32_t> evenly_spaced(std::size_t n, std::size_t count) {
  count = std::min(n, count);
  std::vector<std::uint32_t> chosen(count);
  for (std::size_t k = 0; k < count; ++k) chosen[k] = static_cast<std::uint32_t>(k * n / count);
  return chosen;
}

std::vector<std::uint32_t> every_nth(std::size_t n, std::size_t step) {
  if (step == 0) throw ArgumentError("every_nth: the step must be at least 1");
  std::vector<std::uint32_t> chosen;
  chosen.reserve(n / step + 1);
  for (std::size_t i = 0; i < n; i += step) chosen.push_back(static_cast<std::uint32_t>(i));
  return chosen;
}

}  // namespace sansmesh::inline v1
