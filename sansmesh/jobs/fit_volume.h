// A volume with its reconstruction, to be kept.
#pragma once

#include <cstddef>
#include <vector>

#include "sansmesh/dataset/fitted_volume.h"
#include "sansmesh/jobs/volume_model.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

struct FitVolumeOptions {
  bool all = false;  ///< keep the other arrays as well

  static const OptionSchema& schema();
};

struct FitVolumeReport {
  ReconstructionReport reconstruction;
  std::size_t samples = 0;
  std::vector<std::size_t> by_degree;  ///< polynomials of degree 0, 1, …; empty for methods without coefficients

  static const ReportSchema& schema();
};

struct FitVolumeResult {
  FittedVolume fitted;  ///< what write_volume_file writes, and a VolumeDataset is made of
  FitVolumeReport report;
  /// Those of VolumeModel::field; "no_coefficients": the method has none, and is set up again at each use.
  std::vector<Note> notes;
};

/// The array that the volume was opened with, all its components. Throws as VolumeModel::fit, Cancelled.
FitVolumeResult fit_volume(VolumeModel& volume, const FitVolumeOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
