// Fields around the layer of samples of a volume surface: the side of far points, the domain, and the cut at the
// volume.
#pragma once

#include <memory>
#include <span>

#include "sansmesh/dataset/isosurface.h"
#include "sansmesh/field/ball_union.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/search/kd_tree.h"
#include "sansmesh/surface/foot_field.h"

namespace sansmesh::inline v1 {

/// The side of points too far from an isosurface for the projection: that of the nearest sample of the volume. Values
/// have the right sign; gradients are meaningless. `volume` must outlive the field.
std::unique_ptr<const ScalarField> value_side(const SampledVolume& volume, std::span<const double> values, double value,
                                              const LocalFrame& frame, const Box3& bounds);
/// The same for borders of materials: the side of the tangent plane of the nearest foot.
std::unique_ptr<const ScalarField> plane_side(const SurfaceFeet& feet, const Box3& bounds);

/// The surface's field, defined in the volume only. `volume` must outlive it.
std::unique_ptr<const ScalarField> cut_at_volume(std::unique_ptr<const ScalarField> field, const VolumeDomain& volume,
                                                 const BallUnion& balls);

/// Domain of a surface: the volume and, for borders of materials, which end inside it, the balls of the layer. Negative
/// inside, approximately the distance to the boundary.
class LayerDomain : public ScalarField {
 public:
  /// The arguments must outlive it. `balls`: null for surfaces that end only with the volume.
  LayerDomain(const VolumeDomain& volume, const BallUnion* balls) : volume_(volume), balls_(balls) {
    if (balls) tree_ = KdTree(balls->centers);
  }
  Box3 bounds() const override { return volume_.bounds(); }
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients) const override;
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override;

 private:
  const VolumeDomain& volume_;
  const BallUnion* balls_;
  KdTree tree_;
};

}  // namespace sansmesh::inline v1
