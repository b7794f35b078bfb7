// At which scale, and to which degree, is the surface fitted best everywhere? Internal to partition/.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sansmesh/partition/block_fit.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// What a trial fit of one block says about every degree; the winners are fitted again at the end.
struct Trial {
  /// Weighted mean squared residual of degrees 1 .. (length²). That of planes is also there, unless it is -1, where the
  /// block is to be subdivided and `highest` says that no degree was fitted.
  std::array<float, kMaxDegree> mean_square{-1};
  float effective_count = 0;
  float dropped = 0;         ///< share of the weight on samples that face away: a second sheet
  float reach = 1;           ///< radius of the fit / radius of the support
  std::uint32_t stride = 1;  ///< one sample of so many was used
  float risk = std::numeric_limits<float>::infinity();  ///< expected squared error of the best degree
  float best = std::numeric_limits<float>::infinity();  ///< of the best cut below this block
  float noise = 0;                                      ///< local noise variance
  std::int8_t highest = -1;
  std::uint8_t degree = 0;  ///< chosen
  bool leaf = false;

  /// Of a degree that was fitted, 1 or more.
  float residual(int d) const { return mean_square[static_cast<std::size_t>(d) - 1]; }
  /// Of the best plane; -1: unknown.
  float plane() const { return mean_square[0]; }
};
static_assert(sizeof(Trial) == 48);  // there is one for every cell of every level

/// A block that gets a support.
struct Leaf {
  std::uint64_t order;  ///< Morton code
  std::uint32_t cell;   ///< in its level
  int level;
};

/// Trial fits of all blocks with samples, on all levels, and what follows from them.
struct ScaleChoice {
  int tried = 0;                           ///< finest level that was tried
  int finest = 0;                          ///< finest level worth a fit
  double variance = 0;                     ///< of the noise (length²)
  double accepted = 0;                     ///< rms error that needs no subdivision (length)
  float support = 1.5f;                    ///< radius of a support / circumscribed radius of its block
  float fit = 1.5f;                        ///< radius of a fit's ball of samples / circumscribed radius of its block
  std::vector<std::vector<Trial>> trials;  ///< of each level and cell
  float height = 0;                        ///< BlockFitter::height of the trials (length)
  std::vector<Leaf> leaves;                ///< in Morton order

  /// 0: hardly any noise, to 1: as much as the spacing. 0 also where the options set the size of supports.
  float noisiness() const;
};

/// Makes the levels of the tree that it needs. `diagonal`: of the samples' bounding box. Throws DataError where no
/// block can be fitted.
ScaleChoice choose_scales(SampleTree& tree, const PartitionOptions& options, double diagonal, Progress& progress);

/// A block of a tree: level and Morton code there.
struct BlockKey {
  int level;
  std::uint64_t code;
};

/// The same for what lies below some blocks (which do not overlap), with noise and supports as the whole cloud has them
/// according to `basis`. The tree has the cells of the whole cloud's, down to those that were tried; it need not hold
/// samples farther than a few edges from those blocks. With the options of the whole fit and all samples: its leaves
/// below those blocks again.
ScaleChoice choose_scales_below(const SampleTree& tree, const PartitionOptions& options, const ScaleBasis& basis,
                                std::span<const BlockKey> roots, Progress& progress);

}  // namespace sansmesh::inline v1
