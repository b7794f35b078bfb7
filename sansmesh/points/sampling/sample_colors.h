// Interpolates the colours of samples.
#pragma once

#include "sansmesh/field/color_field.h"
#include "sansmesh/point_set.h"
#include "sansmesh/search/kd_tree.h"

namespace sansmesh::inline v1 {

/// Mean colour of the four nearest samples, weighted by inverse squared distance: components 0..255. The tree contains
/// the samples of `colors` and is not empty.
Vec3 mean_color(const KdTree& samples, std::span<const std::array<std::uint8_t, 3>> colors, const Vec3f& x);

/// Interpolated colours of samples as a ColorField.
class SampleColors : public ColorField {
 public:
  /// Throws DataError if the cloud has no colours.
  explicit SampleColors(const PointSet& points);
  void evaluate(std::span<const Vec3> x, std::span<Vec3f> colors) const override;

 private:
  KdTree tree_;
  std::vector<std::array<std::uint8_t, 3>> colors_;
};

}  // namespace sansmesh::inline v1
