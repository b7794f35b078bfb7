// How far the samples are off the surface.
#pragma once

#include <string>

#include "sansmesh/point_set.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

/// What can be known of the noise of a cloud (lengths).
struct NoiseEstimate {
  double deviation = 0;  ///< as `estimate_noise`
  /// It is no more than this: what the nearest neighbours leave of the samples' heights, shape and noise together.
  double most = 0;
  /// There are neighbourhoods that show the noise by itself, or too little of either to matter. False where shape and
  /// noise look the same, as of few samples, and where steps hide what is smaller.
  bool known = false;
  /// Coordinates come in steps of this height, whole neighbourhoods at the same: depths of a sensor with few digits.
  double step = 0;

  static const ReportSchema& schema();
};

/// Robust estimate of the standard deviation of the samples off the surface, along its normal (unit of the input);
/// 0 with fewer than 20 different points. Quadrics are fitted to neighbourhoods of doubling size at a fixed subsample
/// of places: noise leaves the same residual at every size, curvature one that grows with its cube, creases one that
/// grows with it; the scale where the residual grows least tells the noise. Meant to be right within a fifth where the
/// noise exceeds a hundredth of the spacing, and small against the spacing for clean samples.
double estimate_noise(const PointSet& points);

/// The same, and how sure it is.
NoiseEstimate measure_noise(const PointSet& points);

/// "0.0039", "less than 0.0002", "unknown: 0.02 at most, of shape or noise", "unknown: too few samples", …; `spacing`
/// of the samples (length).
std::string noise_words(const NoiseEstimate& noise, double spacing);

}  // namespace sansmesh::inline v1
