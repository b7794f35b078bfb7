// Options of multi-level partition of unity implicits.
#pragma once

#include <optional>

namespace sansmesh::inline v1 {

struct MpuOptions {
  /// Accepted distance of the samples of a cell from its shape (length): cells with a larger one are divided; default:
  /// default_mpu_error() of the samples' spacing and noise.
  std::optional<double> error = {};
  std::optional<int> max_depth = {};   ///< deepest level of the octree, 2..14; default: 14, which samples do not reach
  bool sharp = true;                   ///< fit edges and corners where a few samples have normals of more than one face
  std::optional<double> spacing = {};  ///< known spacing of the samples, which replaces its estimation (length)
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Default of MpuOptions::error for samples of this spacing and this standard deviation of the noise (lengths).
double default_mpu_error(double spacing, double noise);

}  // namespace sansmesh::inline v1
