// How far a point lies from the surface that samples stand for, and on which side.
#pragma once

#include <span>
#include <vector>

#include "sansmesh/measure/signed_distance.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Distance to discs at the samples, across their normals, that reach as far as their eighth neighbour: near the
/// samples the distance to the surface that they stand for, not to the single sample; farther off that to the rim. Sign
/// and disc are those of the nearest sample. Without normals: the distance to the nearest sample, without a sign.
class PointsDistance : public SignedDistance {
 public:
  /// Keeps a reference to the points (a mesh whose triangles are not looked at). Throws DataError if none is finite.
  explicit PointsDistance(const TriangleMesh& points);

  Box3 bounds() const override { return bounds_; }
  bool has_sides() const override { return !points_.normals.empty(); }
  void measure(std::span<const Vec3> x, double farthest, std::span<MeasuredPoint> found) const override;

 private:
  const TriangleMesh& points_;
  KdTree tree_;
  Box3 bounds_;
  std::vector<float> radius_;  ///< of each disc
};

}  // namespace sansmesh::inline v1
