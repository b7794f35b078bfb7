// The instruction sets that this machine runs and the library has kernels for, one after another.
#pragma once

#include "sansmesh/core/simd_targets.h"
// After simd_targets.h, which says what the library holds.
#include <hwy/targets.h>

#include <cstdint>
#include <vector>

namespace sansmesh::test {

/// Best first; the last one has no vectors.
inline std::vector<std::int64_t> simd_targets() {
  std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  if (targets.empty() || targets.back() != HWY_STATIC_TARGET) targets.push_back(HWY_STATIC_TARGET);
  return targets;
}

/// As long as it lives all kernels of the process run on one target. Not while other threads run kernels.
class OnTarget {
 public:
  explicit OnTarget(std::int64_t target) { hwy::GetChosenTarget().Update(target); }
  ~OnTarget() { hwy::GetChosenTarget().DeInit(); }
  OnTarget(const OnTarget&) = delete;
  OnTarget& operator=(const OnTarget&) = delete;
};

}  // namespace sansmesh::test
