// Signed distance to the surface sampled by a cloud.
#pragma once

#include <span>
#include <vector>

#include "sansmesh/measure/signed_distance.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Distance to discs at the samples, perpendicular to their normals, with the radius of the eighth neighbour: near the
/// samples an approximate distance to the sampled surface, farther away to the disc's rim. The nearest sample
/// determines sign and disc. Without normals: unsigned distance to the nearest sample.
class PointsDistance : public SignedDistance {
 public:
  /// Keeps a reference to the points (a mesh whose triangles are ignored). Throws DataError if no point is finite.
  explicit PointsDistance(const TriangleMesh& points);

  Box3 bounds() const override { return bounds_; }
  bool has_sides() const override { return !points_.normals.empty(); }
  void measure(std::span<const Vec3> x, double farthest, std::span<MeasuredPoint> found) const override;

 private:
  const TriangleMesh& points_;
  KdTree tree_;
  Box3 bounds_;
  std::vector<float> radius_;  ///< radius of each disc
};

/// RMS distance to points from a surface that they sample at random with this spacing and normally distributed noise:
/// along the normal of the nearest point, or to the point itself. Where the noise exceeds the spacing, the nearest
/// point is the one with the least noise of several, so the former stays below the noise.
double rms_to_samples(double spacing, double noise, bool along_normals);

}  // namespace sansmesh::inline v1
