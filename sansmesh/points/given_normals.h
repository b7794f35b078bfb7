// What can be said of the normals that a cloud has.
#pragma once

#include <optional>
#include <string>

#include "sansmesh/point_set.h"
#include "sansmesh/points/orientation.h"
#include "sansmesh/points/sights.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

struct GivenNormals {
  bool oriented = false;     ///< surely, be it inward
  std::string words;         ///< "none", "oriented outward", "not oriented consistently: …"
  OrientationReport report;  ///< by how neighbours agree and where closed parts look
  /// The sensor that all but a few look to, where one is known, and the share that looks away from it: it outweighs
  /// what neighbours say.
  std::optional<OrientBy> oriented_by = {};
  double looking_away = 0;

  static const ReportSchema& schema();
};

/// By what is known of the sensor, or by how neighbours agree. `noise` of the points (length).
GivenNormals judge_normals(const PointSet& points, double noise);
GivenNormals judge_normals(const OrientationReport& report);

}  // namespace sansmesh::inline v1
