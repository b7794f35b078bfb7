// Normals of a cloud, estimated and oriented.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/points/given_normals.h"
#include "sansmesh/points/noise.h"
#include "sansmesh/points/normals.h"
#include "sansmesh/points/sights.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

struct NormalsOptions {
  NormalOptions estimation = {};  ///< its spacing and noise are measured where they are not given
  bool orient_only = false;       ///< orient the given normals instead of estimating new ones
  bool orient = true;             ///< otherwise signs stay as they come
  OrientBy orient_by = OrientBy::automatic;

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct NormalsReport {
  double spacing = 0;  ///< length
  NoiseEstimate noise;
  std::optional<int> neighbours;        ///< of new normals
  std::optional<OrientBy> oriented_by;  ///< from what the signs were taken
  GivenNormals check;                   ///< of what was made
  std::size_t unknown = 0;              ///< samples without a normal: zero

  static const ReportSchema& schema();
};

struct NormalsResult {
  PointSet points;  ///< with normals
  NormalsReport report;
  std::vector<Note> notes;  ///< there are none yet
};

/// Throws ArgumentError for bad options; DataError for fewer than 3 different points, none to keep, and where nothing
/// is known of what `orient_by` asks for; Cancelled.
NormalsResult normals(PointSet points, const NormalsOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
