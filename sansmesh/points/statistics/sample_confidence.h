// Distance of a surface from the samples, and the resulting confidence.
#pragma once

#include <span>
#include <vector>

#include "sansmesh/field/color_field.h"
#include "sansmesh/point_set.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {

/// Confidence of a surface point from its distance d to the nearest sample p:
///
///   c = min(1, max(0, (r − d) / (r − u))),  u = max(s, 3 σ),  r = u + 2 s,
///
/// with the local spacing s of the samples around p and the noise σ. It is 1 within the spacing of the samples and 0
/// where the nearest sample is out of the reach that defines coverage (Coverage: three spacings), as on the filling of
/// a hole. s is √(π d² / 16) with the distance d from p to its 16th neighbour, limited as in Coverage to between ½ and
/// 3 times the mean spacing.
class SampleConfidence {
 public:
  /// Lengths in the samples' unit. `spacing`: of all samples, √(area / count), positive. Throws DataError without
  /// samples.
  SampleConfidence(const PointSet& samples, double spacing, double noise);

  /// Computes distances to the nearest sample (length) and confidences 0..1 of points relative to the samples' origin.
  /// As many entries as points.
  void evaluate(std::span<const Vec3f> x, std::span<float> distances, std::span<float> confidences) const;

 private:
  double reach_spacing(std::uint32_t sample) const;

  KdTree tree_;
  std::vector<Vec3f> positions_;
  double spacing_, noise_;
};

/// Colour of a confidence: white for 1, red for 0.
Vec3f confidence_color(float confidence);

/// Confidence of a surface as a ColorField.
class ConfidenceColors : public ColorField {
 public:
  ConfidenceColors(const PointSet& samples, double spacing, double noise) : confidence_(samples, spacing, noise) {}
  void evaluate(std::span<const Vec3> x, std::span<Vec3f> colors) const override;

 private:
  SampleConfidence confidence_;
};

}  // namespace sansmesh::inline v1
