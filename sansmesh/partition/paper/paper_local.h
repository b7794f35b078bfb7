// Local approximations of the published method: unweighted least squares by orthogonal polynomials of increasing
// degree, with tests of robustness; planes of the nearest samples if there are too few (tejada2008, 4.4.3; polizelli,
// 3.2).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/approximation/orthogonal_polynomials.h"
#include "sansmesh/partition/fit/leaf_fit.h"
#include "sansmesh/partition/local_function.h"
#include "sansmesh/partition/paper/paper_options.h"
#include "sansmesh/partition/partition_data.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {

/// Number of samples for a plane; a support with fewer borrows a plane from the nearest samples.
constexpr std::size_t kEnoughForPlane = std::size_t{paper::kSamplesPerBasis} * kBasisSize[1];

/// Whether a support has too few samples of its own, so that its plane is borrowed.
inline bool is_borrowed(const Support& support) {
  return support.state == Support::fitted && support.samples < kEnoughForPlane;
}

/// A block of the tree with the samples in the ball of its support.
struct PaperBlock {
  int level = 0;
  std::uint64_t code = 0;
  std::vector<std::uint32_t> ids;  ///< ascending
};

/// The approximation of one support.
struct PaperLocal {
  LocalFunction function;
  Support support;          ///< without its patch
  double squares = 0;       ///< sum of squared distances of the samples in its ball (length²)
  bool two_sheets = false;  ///< a normal deviates by 90° or more from the mean (ohtake2003)
  bool good = false;        ///< within the threshold, and one sheet
};

/// Highest degree that both robustness tests allow: number of samples per basis function, and coverage.
int paper_degree(const PaperOptions& options, std::size_t samples, double coverage);

/// Fits blocks of one cloud. The arrays must outlive it. Thread-safe: each thread has a workspace.
class PaperFitter {
 public:
  /// `limit`: the threshold as a length.
  PaperFitter(std::span<const Vec3f> positions, std::span<const Vec3f> normals, const Vec3f& lower, float edge,
              const PaperOptions& options, double limit);

  struct Workspace {
    OrthogonalFit<2> fit;
    std::vector<double> u, v, w;
  };

  float block_edge(int level) const { return edge_ / static_cast<float>(1u << level); }
  Vec3f center(int level, std::uint64_t code) const;
  float radius(int level) const { return static_cast<float>(options_.support * 0.8660254) * block_edge(level); }
  const PaperOptions& options() const { return options_; }
  double limit() const { return limit_; }

  /// Child of a block with its samples, which are a subset of the block's.
  PaperBlock child(const PaperBlock& block, unsigned number) const;
  /// Samples in a ball, ascending.
  std::vector<std::uint32_t> ball(const Vec3f& center, float radius) const;

  /// Cases (i) and (ii): a polynomial if there are enough samples, else a borrowed plane. `exactly`: this degree, or
  /// the highest below it that the samples determine, without the robustness tests; by default the degree increases
  /// until the error is within the limit.
  PaperLocal approximate(const PaperBlock& block, Workspace& ws, int exactly = -1) const;

 private:
  void fit_polynomial(const PaperBlock& block, const Vec3f& nu, Workspace& ws, int exactly, PaperLocal& local) const;
  void borrow_plane(PaperLocal& local) const;

  std::span<const Vec3f> positions_, normals_;
  Vec3f lower_;
  float edge_;
  PaperOptions options_;
  double limit_;
  KdTree nearest_;
};

/// A leaf with the approximation of its support and its patch.
FittedLeaf leaf_of(const PaperFitter& fitter, const PaperLocal& local);

}  // namespace sansmesh::inline v1
