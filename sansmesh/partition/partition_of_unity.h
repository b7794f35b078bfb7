// Adaptive partition of unity implicits (METHODS §3.1): F(x) = Σ f_i(x) θ_i(x) / Σ θ_i(x).
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/core/progress.h"
#include "sansmesh/data/point_set.h"
#include "sansmesh/field/scalar_field.h"
#include "sansmesh/partition/local_function.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh {

struct PartitionOptions {
  std::optional<int> max_depth;  ///< deepest level of the tree, 2..14; default: where supports run out of samples
  std::optional<double> error;   ///< accepted rms error of a local function (length); default: 0.1 noise
  /// Radius of a support / circumscribed radius of its block, 1.1..2; default: 1.5, up to 1.8 where noise is large
  /// against the spacing.
  std::optional<double> support;
  int max_degree = 4;      ///< largest polynomial degree, 1..4
  int min_samples = 9;     ///< a support with fewer samples borrows a larger ball for its fit
  int max_samples = 1000;  ///< beyond this a block is subdivided without fitting (METHODS case iii);
                           ///< on the deepest level only so many of its samples are used
  std::array<double, kMaxDegree + 1> coverage{0, 0, 0.4, 0.6, 0.7};  ///< least coverage k for each degree
  double max_eccentricity = 0.2;  ///< beyond it (a border of the data) only planes: curved fits swing off there
  bool sharp = true;              ///< split supports at creases

  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// What fitting learned about the data.
struct PartitionReport {
  double noise = 0;     ///< rms deviation of the samples from the surface (length)
  double error = 0;     ///< accepted error used (length)
  double accuracy = 0;  ///< estimated rms error of the surface (length)
  double area = 0;      ///< of the surface near samples (length²)
  double spacing = 0;   ///< of the samples: √(area / count) (length)
  int depth = 0;        ///< deepest level used
  std::size_t functions = 0;
  std::array<std::size_t, kMaxDegree + 1> functions_of_degree{};
  std::size_t creased = 0;  ///< supports with a crease or corner
};

class PartitionOfUnity : public ScalarField {
 public:
  ~PartitionOfUnity() override;
  PartitionOfUnity(PartitionOfUnity&&) noexcept;
  PartitionOfUnity& operator=(PartitionOfUnity&&) noexcept;

  Box3 bounds() const override;
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;

  /// Number of local functions and the functions themselves (positions relative to the cloud's origin).
  std::span<const LocalFunction> functions() const;
  const PartitionReport& report() const;

  /// A tree of blocks for polygonisation: fine enough that linear interpolation over its simplices stays within about
  /// `mesh_error` (length) of the surface in the mean, and fine at creases and where sheets come close.
  BlockTree mesh_blocks(double mesh_error) const;

  /// A point on or near the surface in every support: where a walk along the surface may start.
  std::vector<Vec3> seeds() const;

  struct State;  ///< internal

 private:
  friend PartitionOfUnity fit_partition_of_unity(const PointSet&, const PartitionOptions&, Progress&);
  explicit PartitionOfUnity(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Fits to points with oriented normals. Throws DataError for fewer than 4 points or a cloud without extent,
/// ArgumentError for options out of range.
PartitionOfUnity fit_partition_of_unity(const PointSet& points, const PartitionOptions& options, Progress& progress);

}  // namespace sansmesh
