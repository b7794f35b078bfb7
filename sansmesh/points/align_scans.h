// Scans that do not quite fit together: found, and moved.
#pragma once

#include <cstddef>
#include <vector>

#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// x → R x + shift.
struct RigidMotion {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};  ///< columns of the rotation R
  Vec3 shift;

  Vec3 turn(const Vec3& v) const { return x * v.x + y * v.y + z * v.z; }
  Vec3 turn_back(const Vec3& v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
  Vec3 operator()(const Vec3& p) const { return turn(p) + shift; }
  Vec3 inverse(const Vec3& p) const { return turn_back(p - shift); }
};

struct ScanAlignmentOptions {
  std::size_t samples = 5000;  ///< of each scan that are compared with the other scans, 20 or more
  int rounds = 40;             ///< at most so many steps, 1 or more

  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Of each scan (index of PointSet::scan_of_point); lengths in the unit of the points.
struct ScanAlignment {
  std::vector<RigidMotion> motions;  ///< that bring the scans together
  /// Root mean square of what the motion moves its samples across the surface; sliding along it does no harm.
  std::vector<double> displacements;
  /// Standard deviation (robust) of the samples of each scan off the surfaces of the others, as they come.
  std::vector<double> deviations;
  double noise = 0;    ///< typical standard deviation of the samples of a scan off its own surface
  double spacing = 0;  ///< typical spacing of the samples of a scan
  int rounds = 0;      ///< steps taken; 0: no two scans have a place in common

  /// The scan that is moved most, and the one that is farthest off the others; 0 if there are none.
  std::size_t most_moved() const;
  std::size_t farthest_off() const;
  /// Whether a scan is moved by more than the noise, and than can be told by the samples (a tenth of their spacing).
  bool disagree() const;
  /// Whether scans are off each other by more than twice that, and no rigid motion helps: each has its own shape.
  bool warped() const;
};

/// Motions that bring samples of each scan onto the surfaces of the others: all of them at once, by Gauss and Newton's
/// method on the distances from samples to quadrics through the nearest samples of every other scan that has some there
/// [chen1992], [pulli1999], with Tukey's weights that narrow down from 8 spacings to what the noise wants. The mean
/// motion of all samples is zero. Samples whose normals are more than 60° apart do not belong together; scans with
/// fewer than 100 samples stay. Unless the scans are nearer to each other afterwards (the mean loss falls by a tenth),
/// nothing moves: what is left between scans that are warped would be shifted about, not removed. The points have
/// normals (ArgumentError). Throws DataError for more than 300 scans that could be moved.
ScanAlignment find_scan_motions(const PointSet& points, const ScanAlignmentOptions& options, Progress& progress);

/// Moves the samples with all that has directions, and where they were seen from. Throws ArgumentError for motions of
/// fewer scans than there are.
void move_scans(PointSet& points, const std::vector<RigidMotion>& motions);

/// Whether the points are of two scans or more.
bool has_several_scans(const PointSet& points);

}  // namespace sansmesh::inline v1
