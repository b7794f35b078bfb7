// The surface in the middle of a layer of weighted samples, such as voxels whose values are near that of an isosurface
// (METHODS §5.1).
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "sansmesh/field/ball_union.h"
#include "sansmesh/field/projection.h"

namespace sansmesh::inline v1 {

/// Arrays of equal length; neighbours in space should be neighbours in the arrays (KdTree::order).
struct LayerSamples {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;  ///< unit: which side is out
  std::vector<float> weights;  ///< > 0: how near the surface the sample is said to be, times what it stands for
  std::vector<float> spacing;  ///< distance to the samples around (length, > 0)
  std::vector<float> reach;    ///< radius of its ball of the domain (length, >= 0; 0: none)
};

struct LayerOptions {
  double smoothing = 2;  ///< h of the weights over the spacing, 0.5..20
  /// Which of the two run; at least one. The predictor finds the layer from farther away, the corrector the surface.
  bool predictor = true, corrector = true;
  /// Predictor: direction and offset in turns as the source has it, in place of the minimum that they lead to.
  bool alternating = false;
  /// Corrector: the offset minimises the sum along the normal as in the source, in place of a fixed point of means.
  bool line_search = false;
  bool separate_sheets = true;  ///< samples that face away from those nearby are ignored
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// One application is one step of the predictor and one of the corrector. With weights ω_i, all samples whose supports
/// (radius 2h) hold the point r count in the predictor: a plane of least Σ ω_i ⟨n, x_i − q⟩², then over it the
/// polynomial g = Aξ² + Bη² + Cξη + D, r's foot on it. The corrector does the same about that foot with weights ω_i
/// (1 − d²/(2h)²)⁴, which resemble exp(−d²/h²).
class LayerProjection : public Projection {
 public:
  /// Throws ArgumentError for bad options, DataError where there is no sample with a ball.
  LayerProjection(const LayerSamples& samples, const LayerOptions& options);
  ~LayerProjection() override;
  LayerProjection(LayerProjection&&) noexcept;
  LayerProjection& operator=(LayerProjection&&) noexcept;

  Box3 bounds() const override;
  void project(std::span<const Vec3> x, std::span<FootPoint> feet) const override;
  /// Those of the samples that have one.
  BallUnion balls() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sansmesh::inline v1
