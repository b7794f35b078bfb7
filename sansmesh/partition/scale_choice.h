// Chooses the scale and degree of the best fit for each part of the surface.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sansmesh/partition/block_fit.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// Least mean number of samples in a sample's cell on the finest level that is tried. Errors of clean samples are
/// smallest between 3 and 5; fewer samples cost more and cause more handles in rough regions.
inline constexpr double kLeastCompany = 5;

/// Result of a trial fit of one block for every degree; chosen blocks are fitted again at the end.
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

/// A block that receives a support.
struct Leaf {
  std::uint64_t order;  ///< Morton code
  std::uint32_t cell;   ///< index in its level
  int level;
};

/// Trial fits of all blocks with samples, on all levels, and the resulting choices.
struct ScaleChoice : ScaleBasis {
  std::vector<std::vector<Trial>> trials;  ///< by level and cell
  std::vector<Leaf> leaves;                ///< in Morton order

  /// 0: hardly any noise, to 1: as much as the spacing. 0 also if the options set the size of supports.
  float noisiness() const;
};

/// Creates the levels of the tree that it needs. `diagonal`: diagonal of the samples' bounding box. Throws DataError if
/// no block can be fitted.
ScaleChoice choose_scales(SampleTree& tree, const PartitionOptions& options, double diagonal, Progress& progress);

/// Level and Morton code of a block.
struct BlockKey {
  int level;
  std::uint64_t code;
};

/// The same below some blocks (which do not overlap), with the noise and supports of the whole cloud from `basis`. The
/// tree has the cells of the whole cloud's tree, down to the finest tried level; it need not hold samples farther than
/// a few edges from those blocks. With the options of the whole fit and all samples, the result is the leaves of that
/// fit below those blocks.
ScaleChoice choose_scales_below(const SampleTree& tree, const PartitionOptions& options, const ScaleBasis& basis,
                                std::span<const BlockKey> roots, Progress& progress);

}  // namespace sansmesh::inline v1
