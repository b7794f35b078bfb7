// What the robust adaptive partition of unity of the sources asks of its user (tejada2008, section 4.4; polizelli).
#pragma once

#include <array>
#include <cstddef>

#include "sansmesh/fit_options.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {

struct PaperOptions {
  /// Accepted rms distance of a support's samples from its polynomial over the diagonal of the box of all samples:
  /// above it the degree is raised, or the block subdivided. The thesis has 0.002 for the raw Bunny.
  double threshold = 0.002;
  int max_depth = 9;                         ///< deepest level of the tree; the thesis has 9 for the raw Bunny
  int max_degree = 4;                        ///< largest degree, 1..4
  double support = 1.5;                      ///< radius of a support / circumscribed radius of its block, 1.1..2
  PaperCoverage coverage = kThesisCoverage;  ///< each in 0..2

  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Numbers of the sources that are no options.
namespace paper {
constexpr int kSamplesPerBasis = 2;         ///< a degree needs so many samples for each of its basis functions
constexpr std::size_t kFew = 100;           ///< with fewer, a block is only divided if its children are not worse
constexpr std::size_t kMany = 1000;         ///< with more, it is divided without a fit
constexpr std::size_t kCluster = 20;        ///< samples of a borrowed plane: the thesis' number; polizelli has 23
constexpr double kCosBorrowed = 0.8660254;  ///< of π/6: how far off the mean normal a least-squares plane's may be
}  // namespace paper

}  // namespace sansmesh::inline v1
