// What can be chosen of multi-level partition of unity implicits.
#pragma once

#include <optional>

namespace sansmesh::inline v1 {

struct MpuOptions {
  /// Accepted distance of the samples of a cell from its shape (length): cells with a larger one are divided; default:
  /// default_mpu_error() of the samples' spacing and noise.
  std::optional<double> error = {};
  std::optional<int> max_depth = {};   ///< deepest level of the octree, 2..14; default: 14, which samples do not reach
  bool sharp = true;                   ///< edges and corners where few samples tell of more than one face
  std::optional<double> spacing = {};  ///< of the samples, where it is known: saves its estimation (length)
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Of samples so far apart, with noise of this standard deviation (lengths).
double default_mpu_error(double spacing, double noise);

}  // namespace sansmesh::inline v1
