// Options of the robust adaptive partition of unity as published (tejada2008, 4.4; polizelli).
#pragma once

#include <cstddef>

#include "sansmesh/fit_options.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh::inline v1 {

struct PaperOptions {
  /// Accepted rms distance of a support's samples from its polynomial over the diagonal of the box of all samples:
  /// above it the degree is raised, or the block subdivided. The thesis uses 0.002 for the raw Bunny.
  double threshold = 0.002;
  int max_depth = 9;                         ///< deepest level of the tree; the thesis uses 9 for the raw Bunny
  int max_degree = 4;                        ///< largest degree, 1..4
  double support = 1.5;                      ///< radius of a support / circumscribed radius of its block, 1.1..2
  PaperCoverage coverage = kThesisCoverage;  ///< each in 0..2

  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Fixed parameters of the publications.
namespace paper {
constexpr int kSamplesPerBasis = 2;   ///< least number of samples per basis function of a degree
constexpr std::size_t kFew = 100;     ///< with fewer samples, a block is only divided if its children are not worse
constexpr std::size_t kMany = 1000;   ///< with more samples, it is divided without a fit
constexpr std::size_t kCluster = 20;  ///< samples of a borrowed plane: the value of the thesis; polizelli uses 23
constexpr double kCosBorrowed =
    0.8660254;  ///< cosine of π/6, the largest angle between a least-squares plane's normal and the mean normal
}  // namespace paper

}  // namespace sansmesh::inline v1
