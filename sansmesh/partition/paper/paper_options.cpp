#include "sansmesh/partition/paper/paper_options.h"

#include <cmath>

#include "sansmesh/core/check_range.h"

namespace sansmesh::inline v1 {

void PaperOptions::validate() const {
  check_argument(std::isfinite(threshold) && threshold > 0,
                 "`threshold` must be a positive share of the samples' diagonal");
  check_range("max_depth", max_depth, kLeastDepth, kMostDepth);
  check_range("max_degree", max_degree, 1, kMaxDegree);
  check_range("support", support, 1.1, 2);
  for (const double k : coverage) check_argument(k >= 0 && k <= 2, "`coverage` must lie in 0..2 for each degree");
}

}  // namespace sansmesh::inline v1
