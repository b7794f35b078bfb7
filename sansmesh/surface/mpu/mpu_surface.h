// Multi-level partition of unity implicits (ohtake2003).
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "sansmesh/field/ball_union.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/surface/mpu/mpu_options.h"
#include "sansmesh/surface/mpu/mpu_tree.h"

namespace sansmesh::inline v1 {

/// Parameters derived from the data, and statistics of the fit.
struct MpuReport {
  double error = 0;               ///< accepted error (length)
  double spacing = 0, noise = 0;  ///< spacing and noise of the samples (length); 0 if the error was given
  int depth = 0;                  ///< deepest level of the octree
  std::size_t leaves = 0;         ///< leaves of all kinds
  std::size_t general = 0, edges = 0, corners = 0;  ///< leaves with such a shape; the others are height fields
};

/// f = Σ w_i Q_i / Σ w_i over the leaves of an octree that reach x. Each leaf has the quadric, or the quadrics that
/// meet in an edge or a corner, of its samples, or of the nearest ones. Defined in the whole cube, negative inside;
/// closes gaps of the samples. Outside of the cube the value is that at the nearest point of the cube, farther from
/// zero by the distance to it. Near the surface it approximates the distance; far from all samples only its sign is
/// meaningful, which follows a few samples and may be wrong. Gradients are exact except at creases, where they jump.
class MpuSurface : public ScalarField {
 public:
  Box3 bounds() const override;
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  /// Proven bound: f is between the least and the largest value of the shapes that reach the ball.
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override;

  /// Balls around samples.
  struct SampleBalls {
    const KdTree& tree;
    std::span<const float> radii;
  };
  /// Balls around the parts of the surface outside the given balls, that is, those that close holes. As large as cells
  /// where no given ball is near, else as large as the given balls.
  BallUnion gap_balls(const SampleBalls& samples) const;
  const MpuTree& tree() const;
  const MpuReport& report() const;

  struct State;

 private:
  friend MpuSurface make_mpu_surface(const PointSet&, const MpuOptions&, Progress&);
  std::shared_ptr<const State> state_;
};

/// Skips samples without a position or a normal; the order of the others does not matter. Throws ArgumentError for
/// invalid options, DataError without normals, for fewer than 9 samples, or if all coincide.
MpuSurface make_mpu_surface(const PointSet& points, const MpuOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
