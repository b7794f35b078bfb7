// Principal curvatures and directions of a sampled surface, without a mesh.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/surface/fitted_curvatures.h"
#include "sansmesh/surface_options.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

namespace detail {
enum class CurvatureSurface : std::uint8_t;
}  // namespace detail

/// Curvatures at points near a cloud (tejada2008, 4.2). Around x with normal n and tangent coordinates (u, v), each
/// neighbour d = x_i − x gives a directional curvature κ_i = −2⟨n, d⟩/‖d‖². By Euler's theorem χ₁ + χ₂ cos 2θ + χ₃ sin
/// 2θ ≈ κ_i is a linear least-squares problem in three unknowns. Additions to the source: an offset and two slopes as
/// further unknowns, terms of third and fourth degree for samples without noise, and a neighbourhood chosen from the
/// data (curvature_choice.h).
class CurvatureEstimator {
 public:
  /// Copies the data that it needs. Throws ArgumentError for invalid options, DataError for a cloud without normals.
  CurvatureEstimator(const PointSet& points, const CurvatureOptions& options);

  /// Curvatures at points on or next to the surface with unit outward normals there. Undefined if the nearest sample is
  /// farther away than half the neighbourhood's radius. Sizes must agree. Thread-safe; runs in parallel itself.
  void evaluate(std::span<const Vec3> x, std::span<const Vec3> normals, std::span<FittedCurvatures> result) const;
  /// Curvatures at all samples, in the cloud's order.
  std::vector<FittedCurvatures> at_samples(Progress& progress) const;

  /// Number of samples in a neighbourhood; 0 if a radius was given.
  int neighbours() const { return neighbours_; }

 private:
  KdTree tree_;
  std::vector<Vec3f> positions_;  ///< in tree order, like the normals
  std::vector<Vec3f> normals_;
  std::vector<std::uint32_t> slot_of_;
  CurvatureOptions options_;
  int neighbours_ = 0;
  detail::CurvatureSurface surface_{};
  std::size_t cloud_size_ = 0;
};

/// Curvatures at all samples; undefined where positions are not finite or normals are zero. Throws ArgumentError for
/// invalid options, DataError for a cloud without normals.
std::vector<FittedCurvatures> estimate_curvatures(const PointSet& points, const CurvatureOptions& options,
                                                  Progress& progress);

}  // namespace sansmesh::inline v1
