// How far what was made of samples is from them, and how much it can be trusted there.
#pragma once

#include <span>
#include <vector>

#include "sansmesh/field/color_field.h"
#include "sansmesh/point_set.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {

/// The confidence of a point on a surface, from its distance d to the nearest sample p:
///
///   c = min(1, max(0, (r − d) / (r − u))),  u = max(s, 3 σ),  r = u + 2 s,
///
/// with s the local spacing of the samples around p and σ the noise: 1 where samples are as near as they are to each
/// other, 0 where the nearest is out of the reach within which they cover a surface (Coverage: three spacings), as on
/// what closes a hole. s is √(π d² / 16) with the distance d to p's 16th neighbour, as in Coverage between ½ and 3
/// times the spacing of all.
class SampleConfidence {
 public:
  /// Lengths in the unit of the samples. `spacing`: of all of them, √(area / count), above 0. Throws DataError without
  /// samples.
  SampleConfidence(const PointSet& samples, double spacing, double noise);

  /// Distances to the nearest sample (length) and confidences 0..1 of points relative to the samples' origin. As many
  /// as points.
  void evaluate(std::span<const Vec3f> x, std::span<float> distances, std::span<float> confidences) const;

 private:
  double reach_spacing(std::uint32_t sample) const;

  KdTree tree_;
  std::vector<Vec3f> positions_;
  double spacing_, noise_;
};

/// Confidence as colour: white where it is 1, red where it is 0.
Vec3f confidence_color(float confidence);

/// That of a surface, anywhere.
class ConfidenceColors : public ColorField {
 public:
  ConfidenceColors(const PointSet& samples, double spacing, double noise) : confidence_(samples, spacing, noise) {}
  void evaluate(std::span<const Vec3> x, std::span<Vec3f> colors) const override;

 private:
  SampleConfidence confidence_;
};

}  // namespace sansmesh::inline v1
