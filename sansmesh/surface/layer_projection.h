// Projection onto the middle of a layer of weighted samples, such as voxels with values near an isovalue (tejada2008,
// 5.2).
#pragma once

#include <memory>
#include <vector>

#include "sansmesh/field/ball_union.h"
#include "sansmesh/field/projection.h"

namespace sansmesh::inline v1 {

/// Arrays of equal length; neighbours in space should be neighbours in the arrays (KdTree::order).
struct LayerSamples {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;  ///< unit outward normals
  std::vector<float> weights;  ///< > 0: closeness to the surface times the volume or area of the sample
  std::vector<float> spacing;  ///< distance to the neighbouring samples (length, > 0)
  std::vector<float> reach;    ///< radius of its ball of the domain (length, >= 0; 0: none)
};

struct LayerOptions {
  double smoothing = 2;  ///< h of the weights over the spacing, 0.5..20
  /// Steps to run; at least one. The predictor finds the layer from farther away, the corrector the surface.
  bool predictor = true, corrector = true;
  /// Predictor: alternate direction and offset as in tejada2008, instead of computing their common minimum directly.
  bool alternating = false;
  /// Corrector: the offset minimises the sum along the normal as in tejada2008, instead of a fixed point of means.
  bool line_search = false;
  bool separate_sheets = true;  ///< samples that face away from those nearby are ignored
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// One application is one step of the predictor and one of the corrector. The predictor uses all samples with supports
/// (radius 2h) around the point r, with weights ω_i: a plane that minimises Σ ω_i ⟨n, x_i − q⟩², then over it the
/// polynomial g = Aξ² + Bη² + Cξη + D, and the foot of r on it. The corrector repeats this about that foot with weights
/// ω_i (1 − d²/(2h)²)⁴, which approximate exp(−d²/h²).
class LayerProjection : public Projection {
 public:
  /// Throws ArgumentError for invalid options, DataError if no sample has a ball.
  LayerProjection(const LayerSamples& samples, const LayerOptions& options);
  Box3 bounds() const override;
  void project(std::span<const Vec3> x, std::span<FootPoint> feet) const override;
  /// Balls of the samples with reach > 0.
  BallUnion balls() const;

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

}  // namespace sansmesh::inline v1
