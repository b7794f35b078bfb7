// Denoises estimated normals and sharpens them at creases.
#pragma once

#include <optional>

#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

struct NormalDenoisingOptions {
  /// Samples used for estimating the normals, 6..240; estimation blurs creases over their width. Default:
  /// `choose_neighbours` of spacing and noise, as in `estimate_normals`.
  std::optional<int> neighbours = {};
  /// Replace the normal of a sample with few neighbours in its tangent plane by that of a neighbour whose plane
  /// contains more.
  bool vote = true;
  /// Rounds of bilateral averaging, 0..20.
  int rounds = 3;
  /// Standard deviation of the averaging over angles between normals (radians, (0, π/2]).
  double angle = 0.2;
  /// Known spacing and noise (lengths), saves their estimation.
  std::optional<double> spacing = {}, noise = {};
  /// Throws ArgumentError that names the field.
  void validate() const;
};

/// Replaces points.normals (tejada2008, 4.3.2). Estimates from neighbours blur creases: near a crease they are between
/// the normals of the two faces. First, each sample considers the normals of neighbours up to twice the blur width
/// away. It adopts the plane through the sample that contains most of its near neighbours, if that has clearly more
/// support than its own. Then bilateral averaging [jones2004]: n ← normalise Σ w(distance) w(angle) w(height over the
/// plane) n_j. Works with any signs and keeps them; zero normals stay zero. Throws ArgumentError for invalid options,
/// DataError for a cloud without normals.
void denoise_normals(PointSet& points, const NormalDenoisingOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
