// Advice on a volume: what can be made of it, by which method and with which arrays.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/advise/advise_volume.h"
#include "sansmesh/jobs/volume_model.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

struct VolumeAdvice {
  VolumeOffer offer;  ///< what there is, with traits of the array and the method that suits it
  std::vector<VolumeRecommendation> recommendations;
  std::string array;  ///< that surfaces and pictures are of: of vectors the magnitude; empty of bare grids
  double value = 0;   ///< of surfaces: the middle of the range, of vectors the mean of their lengths
  std::string flow;   ///< the array of vectors; empty if there is none
  /// Ends of a line across the flow, through the middle of the box, that surfaces of the flow may start from.
  std::optional<std::array<Vec3, 2>> seeds;

  static const ReportSchema& schema();
};

/// Throws DataError where there is neither an array nor a body, Cancelled.
VolumeAdvice advise(VolumeModel& volume, Progress& progress);

}  // namespace sansmesh::inline v1
