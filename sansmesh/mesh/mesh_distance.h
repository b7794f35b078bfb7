// How far two surfaces are from each other.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct DistanceOptions {
  /// Samples on each mesh, spread evenly over its area, 1..2^31; of a cloud every point is compared. Maxima include all
  /// vertices as well.
  std::size_t samples = 300000;
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// From the samples of one surface to the closest points of the other. Lengths in the unit of the input.
struct OneWayDistance {
  std::size_t samples = 0;
  double mean = 0, rms = 0, p95 = 0, max = 0;
  /// Mean angle in degrees between the normals at a sample and its closest point: of the planes (0..90), and with
  /// regard to the normals' signs (0..180). Absent where a side is points without normals.
  std::optional<double> angle, signed_angle;

  static const ReportSchema& schema();
};

struct SurfaceDistance {
  OneWayDistance to_reference;    ///< accuracy: is what was made where it should be?
  OneWayDistance from_reference;  ///< completeness: is all there?
  double diagonal = 0;            ///< of the reference's bounding box
  /// A length in percent of the reference's diagonal.
  double percent(double length) const { return diagonal > 0 ? 100 * length / diagonal : 0; }
};

/// Measures both ways. A mesh without triangles is a set of points, whose distance is that to the nearest point: it
/// does not fall below the half of their spacing, however good the other side is. Origins may differ. Samples are
/// placed by a fixed rule, so results repeat, for any number of threads. Throws DataError if a side has no finite
/// points.
SurfaceDistance measure_distance(const TriangleMesh& surface, const TriangleMesh& reference,
                                 const DistanceOptions& options, Progress& progress);

/// Distances of one way with their shares of the reference's diagonal, for people.
std::string distance_words(const OneWayDistance& distance, const SurfaceDistance& both);

}  // namespace sansmesh::inline v1
