// Vectorised sums over the supports of amls.
#pragma once

#include <cstddef>
#include <span>

#include "sansmesh/vec.h"

namespace sansmesh::inline v1::detail {

/// Supports in blocks of sixteen. A block has kShared rows of sixteen floats (center x, y, z; M by rows; 1 / radius²)
/// and for each component kOwn more (constant; coefficients of x, y, z, x², xy, xz, y², yz, z² in M d).
struct AmlsBlock {
  static constexpr std::size_t kWide = 16, kShared = 13, kOwn = 10;
  static constexpr std::size_t floats(std::size_t components) { return kWide * (kShared + kOwn * components); }
  /// Fills a lane with a support that reaches no point.
  static void clear(float* block, std::size_t lane, std::size_t components) {
    for (std::size_t row = 0; row < kShared + kOwn * components; ++row) block[kWide * row + lane] = 0;
    for (std::size_t k = 0; k < 3; ++k) block[kWide * k + lane] = 1e18f, block[kWide * (3 + 4 * k) + lane] = 1;
    block[kWide * 12 + lane] = 1;
  }
};

/// φ = exp(−2 t) (1 − t)⁴ (l0 + l1 t + l2 t²).
struct AmlsLaguerre {
  float l0 = 1, l1 = 0, l2 = 0;
};

/// Sums over the supports at one point: Σ w, Σ |φ|, Σ φ p, and their gradients.
struct AmlsSums {
  float weight, size, value;
  float weight_slope[3], size_slope[3], value_slope[3];
};

/// Sums at each x for one component. `blocks` are aligned to 64 bytes. Gradients are only written if requested. The
/// result is the same on every machine.
void sum_amls(const float* blocks, std::size_t block_count, std::size_t components, std::size_t component,
              const AmlsLaguerre& laguerre, std::span<const Vec3f> x, bool gradient, AmlsSums* sums);

}  // namespace sansmesh::inline v1::detail
