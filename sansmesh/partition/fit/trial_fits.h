// Trial fits of the blocks with samples on all levels, and the choices among them.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "sansmesh/partition/fit/block_fit.h"

namespace sansmesh::inline v1 {

/// Result of a trial fit of one block for every degree.
struct Trial {
  /// Weighted mean squared residual of degrees 1 .. (length²). That of planes is always set, except for blocks to be
  /// subdivided with `highest` below 0, where it may be -1.
  std::array<float, kMaxDegree> mean_square{-1};
  float effective_count = 0;
  float dropped = 0;         ///< share of the weight of samples that face away: a second sheet
  float reach = 1;           ///< radius of the fit / radius of the support
  std::uint32_t stride = 1;  ///< every stride-th sample was used
  float risk = std::numeric_limits<float>::infinity();  ///< expected squared error of the best degree
  float best =
      std::numeric_limits<float>::infinity();  ///< expected squared error of the best subdivision of this block
  float noise = 0;                             ///< local noise variance
  std::int8_t highest = -1;
  std::uint8_t degree = 0;  ///< chosen degree
  bool leaf = false;

  /// Residual of a fitted degree >= 1.
  float residual(int d) const { return mean_square[static_cast<std::size_t>(d) - 1]; }
  /// Residual of the best plane; -1: unknown.
  float plane() const { return mean_square[0]; }
};
static_assert(sizeof(Trial) == 48);  // one per cell of every level

/// The function of the highest degree of a trial. Chosen blocks need no second fit if they have this degree, no noise
/// and no crease.
struct KeptFit {
  Vec3f nu;
  std::array<float, 15> coefficient;
  double mean_square = 0;  ///< as DegreeFits::mean_square
  float coverage = 0, least_cosine = 1;
  std::uint32_t samples = 0;  ///< 0: none
};

/// A block that receives a support.
struct Leaf {
  std::uint64_t order;  ///< Morton code
  std::uint32_t cell;   ///< index in its level
  int level;
};

/// Trial fits of all blocks with samples, on all levels, and the resulting choices.
struct ScaleChoice : ScaleBasis {
  std::vector<std::vector<Trial>> trials;  ///< by level and cell
  std::vector<KeptFit> kept;               ///< by cell of level `kept_level`, which has most of the blocks
  int kept_level = -1;
  std::vector<Leaf> leaves;  ///< in Morton order
};

}  // namespace sansmesh::inline v1
