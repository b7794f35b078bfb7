// Density of the samples in the children of blocks.
#pragma once

#include <vector>

#include "sansmesh/partition/fit/sample_tree.h"

namespace sansmesh::inline v1 {

/// Decides whether samples are dense enough for separate fits of the children of a block. A ball with few samples, or
/// with samples on one scan line, has small residuals, which are no evidence of a good fit between the samples.
class ChildDensity {
 public:
  /// Measures the blocks of a level of the tree; the tree has the next level, too.
  ChildDensity(const SampleTree& tree, int level);

  /// Whether the children of the blocks `around` hold enough samples, spread in two directions. `two_sheets`: share, 0
  /// to 1, of these blocks that contain a second sheet. Thin walls and fingers need smaller blocks with fewer samples,
  /// and fingers extend in one direction.
  bool suffices(const SampleTree::Neighbours& around, float two_sheets) const;

 private:
  /// Sums over the children of a block.
  struct Sums {
    float samples = 0, squares = 0;  ///< Σ m and Σ m² of their numbers of samples
    float areas = 0, traces = 0;     ///< Σ λ1 λ2 and Σ (λ1 + λ2)² of the principal variances of their samples
  };
  std::vector<Sums> sums_;  ///< by cell
};

}  // namespace sansmesh::inline v1
