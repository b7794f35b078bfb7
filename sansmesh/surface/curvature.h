// Principal curvatures and directions of a sampled surface, without a mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/surface_options.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Curvatures anywhere near a cloud (METHODS §2.2). Around x with normal n and tangent coordinates (u, v), each
/// neighbour d = x_i − x gives a directional curvature κ_i = −2⟨n, d⟩/‖d‖², and Euler's theorem makes χ₁ + χ₂ cos 2θ +
/// χ₃ sin 2θ ≈ κ_i a linear least-squares problem in three unknowns. Beyond the source: an offset and two slopes as
/// further unknowns, and the neighbourhood chosen from the data.
class CurvatureEstimator {
 public:
  /// Copies what it needs of the cloud. Throws ArgumentError for bad options, DataError for a cloud without normals.
  CurvatureEstimator(const PointSet& points, const CurvatureOptions& options);

  /// Curvatures at points on or next to the surface with unit outward normals there. Undefined where the nearest sample
  /// is farther away than half the neighbourhood's radius. Sizes must agree. Safe from several threads; runs in
  /// parallel itself.
  void evaluate(std::span<const Vec3> x, std::span<const Vec3> normals, std::span<PrincipalCurvatures> result) const;
  /// Curvatures at all samples, in the cloud's order.
  std::vector<PrincipalCurvatures> at_samples(Progress& progress) const;

  /// Samples in a neighbourhood; 0 where a radius was given.
  int neighbours() const { return neighbours_; }

 private:
  KdTree tree_;
  std::vector<Vec3f> positions_;  ///< in tree order, like the normals
  std::vector<Vec3f> normals_;
  std::vector<std::uint32_t> slot_of_;
  CurvatureOptions options_;
  int neighbours_ = 0;
  std::size_t cloud_size_ = 0;
};

/// Neighbours that make the expected error of the curvatures least: a few hundred places are fitted with
/// neighbourhoods of 20 to 640 samples. What the noise does to a fit follows from the fit's weights; what the shape
/// does is seen in how the curvatures change from one size to the next.
int choose_curvature_neighbours(const PointSet& points, double noise);

/// Curvatures at all samples; not defined where positions are not finite or normals zero. Throws ArgumentError for bad
/// options, DataError for a cloud without normals.
std::vector<PrincipalCurvatures> estimate_curvatures(const PointSet& points, const CurvatureOptions& options,
                                                     Progress& progress);

}  // namespace sansmesh::inline v1
