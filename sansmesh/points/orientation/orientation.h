// Checks and establishes consistent signs of normals.
#pragma once

#include <optional>
#include <span>

#include "sansmesh/cloud_options.h"
#include "sansmesh/point_set.h"
#include "sansmesh/points/normals/sensor_directions.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

class KdTree;

/// Normals with lower agreement, or with a lower share of related ones, are unoriented.
inline constexpr double kLeastAgreement = 0.9, kLeastRelated = 0.5;

/// Assesses points.normals on a fixed subset: reorients it and checks whether that removes disagreement of whole
/// regions with their surroundings. Individual wrong signs (noise) and thin parts do not count. Parts that are far from
/// closed, such as terrain, have no outside and are never `inward`. A known `noise` (length) saves its estimation.
/// Without `with_doubt`, in less time, `doubt` is 0.
OrientationReport measure_orientation(const PointSet& points, std::optional<double> noise = {}, bool with_doubt = true);

struct OrientationOptions {
  /// Neighbours that each sample is compared with, 4..100.
  int neighbours = 10;
  /// Known noise (length), saves its estimation.
  std::optional<double> noise = {};
  /// Source of the signs. Automatic: the first in the order of OrientBy that is known and agrees with the smooth parts
  /// of the cloud. Others: that source regardless of the normals.
  OrientBy by = OrientBy::automatic;
  /// Throws ArgumentError that names the field.
  void validate() const;
};

/// Flips points.normals such that neighbours agree and each connected part faces its sensor or, if that is unknown,
/// outward. Propagates signs along a neighbour graph from the most to the least reliable edges (after [hoppe1992]):
/// first within smooth patches, then between patches by the vote of all connecting edges, with the rule of [koenig2009]
/// across creases. Samples that clearly face the sensor or clearly face away are fixed from the start, with the
/// automatic source `up` unless another sheet hides them from above; parts without such samples are oriented by their
/// extremal points and volume, and doubtful ones by winding numbers [wnnc2024]. Zero normals stay zero, and those that
/// are not finite have no effect. Returns the source of the signs. Throws DataError if there are no normals, or the
/// source `options.by` is unknown.
OrientBy orient_normals(PointSet& points, const OrientationOptions& options, Progress& progress);

/// Same, with an existing tree of the positions.
OrientBy orient_normals(PointSet& points, const KdTree& tree, const OrientationOptions& options, Progress& progress);

/// Share of normals facing away from the sensor, among those that clearly face it or clearly face away (more than 15°
/// from perpendicular). `directions`: as find_sensor_directions. 0 if there are none.
double share_facing_away(const PointSet& points, std::span<const Vec3f> directions);

}  // namespace sansmesh::inline v1
