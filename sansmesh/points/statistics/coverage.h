// Regions of a surface that samples cover, and the boundary of these regions.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sansmesh/scalar_field.h"
#include "sansmesh/search/ball_tree.h"

namespace sansmesh::inline v1 {

/// Field of one-sidedness of the samples around a point, minus its value half a spacing beyond a straight border:
/// negative where samples cover the surface, positive elsewhere. With the samples p in whose reach r the point x is,
/// and w = (1 − d²/r²)²,
///
///   one-sidedness(x) = ‖Σ w (p − x)/r‖ / Σ w :
///
/// 0 among samples, 0.29 at a straight border, 1 where the last sample is out of reach. It averages about 30 samples,
/// so that its contour does not follow individual ones. A hole narrower than two reaches is surrounded by samples and
/// therefore closed.
class Coverage : public ScalarField {
 public:
  /// `spacing`: of all samples, √(area / count) (length). `fill`: closes holes up to this width (length) with sparser
  /// samples whose reach is half of it; they extend a tenth of their reach beyond a straight border. Default: closes
  /// only holes narrower than 6 local spacings, such as gaps between scan lines.
  Coverage(std::span<const Vec3f> samples, double spacing, std::optional<double> fill = {});

  /// From points that represent samples with these spacings (lengths, one per point).
  Coverage(std::span<const Vec3f> points, std::span<const float> spacings, std::optional<double> fill = {});

  Box3 bounds() const override { return bounds_; }
  /// Gradients are not available: they are zero.
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  /// Positive where no sample is in reach, otherwise unknown.
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override;

  /// Sample at a border, the largest distance of the border, and the local spacing, which limits the width of features
  /// along it.
  struct Border {
    Vec3f position;
    float reach, spacing;
    Vec3f inward;  ///< unit vector towards its neighbours
  };
  std::vector<Border> borders() const;

 private:
  /// Samples with one search tree.
  struct Layer {
    std::vector<Vec3f> samples;
    std::vector<float> reach;
    BallTree tree;

    /// Weighted mean direction to the samples in reach, in reaches.
    Vec3f to_samples(const Vec3f& x, std::vector<std::uint32_t>& near) const;
    bool reaches(const Box3f& box, std::vector<std::uint32_t>& near) const;
  };
  double value(const Vec3f& x, std::vector<std::uint32_t>& near) const;
  /// Builds the trees over the samples in all_ and, if `fill` exceeds their reach, over sparser samples that close wide
  /// holes.
  void build(std::span<const Vec3f> samples, double fill, double least);

  Layer all_;
  std::optional<Layer> wide_;  ///< fewer samples with a longer reach
  Box3 bounds_;
};

}  // namespace sansmesh::inline v1
