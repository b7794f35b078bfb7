// Supports that hold a crease or a corner: one polynomial for each side, joined by max or min (Ohtake et al. 2003, §4;
// METHODS §2.1).
#pragma once

#include <span>
#include <vector>

#include "sansmesh/partition/local_fit.h"
#include "sansmesh/partition/local_function.h"

namespace sansmesh::inline v1 {

struct CreaseFit {
  /// In the order they are joined; a single one where the ball barely touches the other sheet; empty: no crease found.
  std::vector<LocalFunction> pieces;
  double mean_square = 0;  ///< weighted mean squared residual of all samples (length²)
};

/// Splits the samples by their normals into two or three sheets and fits each. `center`, `scale`: of the support's
/// frame; `weights`: of the samples. A single sample is no sheet. No crease where the normals spread
/// less than about 30° or where the sheets are not consistently convex or concave.
CreaseFit fit_crease(std::span<const Vec3f> positions, std::span<const Vec3f> normals, std::span<const float> weights,
                     const Vec3f& center, float scale, int max_degree);

}  // namespace sansmesh::inline v1
