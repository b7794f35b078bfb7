// Unoriented normals from neighbouring samples.
#pragma once

#include <cstddef>
#include <optional>

#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

class KdTree;

struct NormalOptions {
  enum class Method {
    covariance,  ///< plane through the neighbours: direction of least variance (Hoppe et al. 1992)
    jet          ///< quadratic height function over that plane (Cazals & Pouget 2005): unbiased by curvature
  };
  Method method = Method::jet;
  /// Samples in a neighbourhood, 6..500; default: `choose_neighbours` of the estimated spacing and noise.
  std::optional<int> neighbours = {};
  /// Rounds of reweighting, 0..10, that reduce the weight of samples off the fitted plane: outliers, the other side of
  /// a crease or of a thin sheet. Sharper at creases, a little less steady under noise, half as fast.
  int reweightings = 0;
  /// Known spacing and noise (lengths), to save their estimation; used where `neighbours` is absent.
  std::optional<double> spacing = {}, noise = {};

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Neighbours that keep the error of the normals from the noise near a few degrees: more where the noise is large
/// against the spacing.
int choose_neighbours(double spacing, double noise);

/// Replaces points.normals by unit normals of arbitrary sign (zero where all neighbours coincide or the position is not
/// finite). `orient_normals` gives them their sign. Throws ArgumentError for bad options.
void estimate_normals(PointSet& points, const NormalOptions& options, Progress& progress);

/// The same with a tree of the positions at hand.
void estimate_normals(PointSet& points, const KdTree& tree, const NormalOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
