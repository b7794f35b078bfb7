// Detects and corrects misregistration of scans.
#pragma once

#include <cstddef>
#include <vector>

#include "sansmesh/data/similarity.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct ScanAlignmentOptions {
  std::size_t samples = 5000;  ///< samples per scan that are compared with the other scans, at least 20
  int rounds = 40;             ///< largest number of steps, at least 1

  /// Throws ArgumentError that names the field.
  void validate() const;
};

/// Result per scan (index of PointSet::scan_of_point); lengths in the unit of the points.
struct ScanAlignment {
  std::vector<Similarity> motions;  ///< rigid motions that align the scans
  /// Displacement of the samples perpendicular to the surface, root mean square; sliding along it is harmless.
  std::vector<double> displacements;
  /// Robust standard deviation of the samples of each scan from the surfaces of the others, before alignment.
  std::vector<double> deviations;
  double noise = 0;    ///< typical standard deviation of the samples of a scan from its own surface
  double spacing = 0;  ///< typical spacing of the samples of a scan
  int rounds = 0;      ///< number of steps; 0 if no two scans overlap

  /// Scan with the largest displacement, and scan with the largest deviation; 0 if there are none.
  std::size_t most_moved() const;
  std::size_t farthest_off() const;
  /// Whether a scan is displaced by more than the noise and the resolution of the samples (a tenth of their spacing).
  bool disagree() const;
  /// Whether scans deviate by more than twice that and rigid motions do not help: their shapes differ.
  bool warped() const;
};

/// Finds motions that align each scan with the surfaces of the others, for all scans simultaneously. Uses Gauss–Newton
/// on the distances from samples to quadrics through the nearest samples of every overlapping scan [chen1992],
/// [pulli1999], with Tukey weights whose width decreases from 8 spacings to the noise level. The mean motion of all
/// samples is zero. Ignores pairs whose normals differ by more than 60°, and fixes scans with fewer than 100 samples.
/// If alignment does not reduce the mean loss by a tenth, all motions are the identity: motions would only redistribute
/// the deviations of warped scans. The points need normals (ArgumentError). Throws DataError for more than 300 movable
/// scans.
ScanAlignment find_scan_motions(const PointSet& points, const ScanAlignmentOptions& options, Progress& progress);

/// Moves the samples, their normals and the scanner positions. Throws ArgumentError if there are fewer motions than
/// scans.
void move_scans(PointSet& points, const std::vector<Similarity>& motions);

/// Whether the points belong to two or more scans.
bool has_several_scans(const PointSet& points);

}  // namespace sansmesh::inline v1
