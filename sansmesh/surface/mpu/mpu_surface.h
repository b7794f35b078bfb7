// Multi-level partition of unity implicits: Ohtake, Belyaev, Alexa, Turk & Seidel, SIGGRAPH 2003 ([ohtake2003]).
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

/// What fitting learned about the data.
struct MpuReport {
  double error = 0;               ///< accepted (length)
  double spacing = 0, noise = 0;  ///< of the samples (length); 0 where the error was given and they were not needed
  int depth = 0;                  ///< deepest level of the octree
  std::size_t leaves = 0;         ///< of all kinds
  std::size_t general = 0, edges = 0, corners = 0;  ///< leaves with such a shape; the others have heights
};

/// f = Σ w_i Q_i / Σ w_i over the leaves of an octree that reach x, each with the quadric, or quadrics that meet in an
/// edge or a corner, of its samples, or of the nearest ones: defined in the whole cube, negative inside, closed where
/// samples leave gaps. Outside of the cube it is the value at its nearest point, farther from zero by the distance to
/// that. Near the surface about a distance; far from all samples only the sign of what few of them say, which need not
/// be right. Gradients are exact but at creases, where they jump.
class MpuSurface : public ScalarField {
 public:
  Box3 bounds() const override;
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  /// Proven: f lies between the least and the largest value of the shapes that reach the ball.
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override;

  /// Balls around samples.
  struct SampleBalls {
    const KdTree& tree;
    std::span<const float> radii;
  };
  /// Around what of the surface these do not hold: what closes holes. As large as cells where no ball is near, else as
  /// the balls.
  BallUnion gap_balls(const SampleBalls& samples) const;
  const MpuTree& tree() const;
  const MpuReport& report() const;

  struct State;  ///< internal

 private:
  friend MpuSurface make_mpu_surface(const PointSet&, const MpuOptions&, Progress&);
  std::shared_ptr<const State> state_;
};

/// Samples without a position or a normal are left out; the order of the others does not matter. Throws ArgumentError
/// for bad options, DataError where there are no normals, or fewer than 9 samples, or all coincide.
MpuSurface make_mpu_surface(const PointSet& points, const MpuOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
