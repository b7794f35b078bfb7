// Instruction sets of this machine for which the library has kernels.
#pragma once

#include "sansmesh/core/simd_targets.h"
// Must follow simd_targets.h, which defines the library's instruction sets.
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

/// Selects the target of all kernels of the process while it lives. No other thread may run kernels meanwhile.
class OnTarget {
 public:
  explicit OnTarget(std::int64_t target) { hwy::GetChosenTarget().Update(target); }
  ~OnTarget() { hwy::GetChosenTarget().DeInit(); }
  OnTarget(const OnTarget&) = delete;
  OnTarget& operator=(const OnTarget&) = delete;
};

}  // namespace sansmesh::test
