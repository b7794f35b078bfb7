// Where samples cover a surface, and where it ends because they do.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sansmesh/scalar_field.h"
#include "sansmesh/search/ball_tree.h"

namespace sansmesh::inline v1 {

/// How one-sidedly the samples around a point lie, less what that is half a spacing beyond a straight border: negative
/// where a surface is covered by samples, positive where it is not. With the samples p in reach r of x, each with a
/// reach of its own, and w = (1 − d²/r²)²,
///
///   one-sidedness(x) = ‖Σ w (p − x)/r‖ / Σ w :
///
/// 0 among samples, 0.29 at a straight border, and 1 where the last sample is out of reach. It is a mean over about 30
/// samples, so that its contour does not follow single ones; and a hole narrower than two reaches is surrounded by
/// samples, and closed.
class Coverage : public ScalarField {
 public:
  /// `spacing`: of all samples, √(area / count) (length). `fill`: holes up to so wide are closed (length), by samples
  /// farther apart with a reach of half as much, which reach a tenth of that beyond a straight border; default: only
  /// those narrower than 6 times the local spacing, as gaps between the lines of a scanner want it.
  Coverage(std::span<const Vec3f> samples, double spacing, std::optional<double> fill = {});

  /// Of places that stand for samples so far apart (lengths, as many as places).
  Coverage(std::span<const Vec3f> places, std::span<const float> spacings, std::optional<double> fill = {});

  Box3 bounds() const override { return bounds_; }
  /// No gradients: asked for, they are zero.
  void evaluate(std::span<const Vec3> x, std::span<double> values, std::span<Vec3> gradients = {}) const override;
  /// Above 0 where no sample is in reach, else unknown.
  void ranges(std::span<const Vec3> x, double radius, std::span<ValueRange> found) const override;

  /// A sample at a border: how far the border is from there at most, and how wide what happens along it.
  struct Border {
    Vec3f position;
    float reach, spacing;
    Vec3f inward;  ///< unit vector to where its neighbours are
  };
  std::vector<Border> borders() const;

 private:
  /// Samples that are looked at together.
  struct Layer {
    std::vector<Vec3f> samples;
    std::vector<float> reach;
    BallTree tree;

    /// Weighted mean of the way to the samples in reach, in reaches.
    Vec3f to_samples(const Vec3f& x, std::vector<std::uint32_t>& near) const;
    bool reaches(const Box3f& box, std::vector<std::uint32_t>& near) const;
  };
  double value(const Vec3f& x, std::vector<std::uint32_t>& near) const;
  /// The trees over what all_ holds and, if that reaches farther, what closes wide holes.
  void build(std::span<const Vec3f> samples, double fill, double least);

  Layer all_;
  std::optional<Layer> wide_;  ///< fewer, with a longer reach
  Box3 bounds_;
};

}  // namespace sansmesh::inline v1
