// A volume on a uniform grid.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "sansmesh/dataset/resample_volume.h"
#include "sansmesh/grid_data.h"
#include "sansmesh/jobs/volume_model.h"
#include "sansmesh/note.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

struct ResampleReport {
  ReconstructionReport reconstruction;
  std::array<std::size_t, 3> size{};  ///< values along the axes
  double inside = 0;                  ///< share of the values that lie in the volume

  static const ReportSchema& schema();
};

struct ResampleResult {
  GridBlock block;  ///< as resample_volume makes it
  ResampleReport report;
  std::vector<Note> notes;  ///< those of VolumeModel::field
};

/// The array that the volume was opened with. Throws as VolumeModel::field, ArgumentError for bad options, DataError
/// where values do not fit into floats, Cancelled.
ResampleResult resample(VolumeModel& volume, const ResampleOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
