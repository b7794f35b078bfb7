#include "sansmesh/partition/paper_options.h"

#include <fmt/core.h>

#include <cmath>
#include <string>

#include "sansmesh/error.h"
#include "sansmesh/partition/local_function.h"

namespace sansmesh::inline v1 {

void PaperOptions::validate() const {
  const auto check = [](bool ok, const std::string& what) {
    if (!ok) throw ArgumentError(what);
  };
  check(std::isfinite(threshold) && threshold > 0, "`threshold` must be a positive share of the samples' diagonal");
  check(max_depth >= kLeastDepth && max_depth <= kMostDepth,
        fmt::format("`max_depth` must lie in {}..{}", kLeastDepth, kMostDepth));
  check(max_degree >= 1 && max_degree <= kMaxDegree, "`max_degree` must lie in 1..4");
  check(support >= 1.1 && support <= 2, "`support` must lie in 1.1..2");
  for (const double k : coverage) check(k >= 0 && k <= 2, "`coverage` must lie in 0..2 for each degree");
}

}  // namespace sansmesh::inline v1
