// Fits of supports with a crease or a corner: one polynomial for each side, joined by max or min (ohtake2003, section
// 4).
#pragma once

#include <span>
#include <vector>

#include "sansmesh/partition/fit/local_fit.h"
#include "sansmesh/partition/local_function.h"

namespace sansmesh::inline v1 {

struct CreaseFit {
  /// In joining order; a single one if the ball barely touches the other sheet; empty: no crease found.
  std::vector<LocalFunction> pieces;
  double mean_square = 0;  ///< weighted mean squared residual of all samples (length²)
};

/// Splits the samples by their normals into two or three sheets and fits each. `center`, `scale`: the support's frame;
/// `weights`: the samples' weights. Only the first `inner` samples are in the support; those after complete sheets of
/// fewer than four. A single sample is no sheet. Returns no crease if the normals spread less than about 10°, or if the
/// sheets are not consistently convex or concave.
CreaseFit fit_crease(std::span<const Vec3f> positions, std::span<const Vec3f> normals, std::span<const float> weights,
                     std::size_t inner, const Vec3f& center, float scale, int max_degree);

/// Cosine of the largest angle between the normals of two pieces.
float least_cosine(std::span<const LocalFunction> pieces);

}  // namespace sansmesh::inline v1
