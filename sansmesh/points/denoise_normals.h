// Estimated normals made sharp at creases and steadier elsewhere.
#pragma once

#include <optional>

#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

struct NormalDenoisingOptions {
  /// Samples that the normals were estimated from, 6..240: creases are blurred as wide as that. Default:
  /// `choose_neighbours` of spacing and noise, as `estimate_normals` does.
  std::optional<int> neighbours = {};
  /// Give samples whose tangent plane few neighbours lie in the normal of a neighbour whose plane holds more.
  bool vote = true;
  /// Rounds of bilateral averaging, 0..20.
  int rounds = 3;
  /// Standard deviation of the averaging over angles between normals (radians, (0, π/2]).
  double angle = 0.2;
  /// Known spacing and noise (lengths), to save their estimation.
  std::optional<double> spacing = {}, noise = {};
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Replaces points.normals (METHODS §2.4). Estimates from neighbours blur creases: near one, they lie between those of
/// the two faces. First each sample is offered the normals of neighbours up to twice as far as the blur reaches; the
/// plane through the sample that most of its near neighbours lie in wins, if it holds clearly more than its own. Then
/// bilateral averages (Jones et al. 2004): n ← normalise Σ w(distance) w(angle) w(height over the plane) n_j. Works
/// with any signs, and keeps them; zero normals stay zero. Throws ArgumentError for bad options, DataError for a cloud
/// without normals.
void denoise_normals(PointSet& points, const NormalDenoisingOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
