// A volume that changes in time: its steps, all open at once.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sansmesh/jobs/volume_model.h"
#include "sansmesh/note.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

struct VolumeSeries {
  std::vector<VolumeModel> steps;  ///< two at least; array and method of all are those of the first
  std::vector<double> times;       ///< of the steps
  std::string name;                ///< of the files
  std::vector<Note> notes;         ///< of reading, of all steps

  static const ReportSchema& schema();
};

/// All steps of a file, or several files one after the other. `times`: of files, each, or the first and the step
/// between them; 0, 1, 2, … if there are none. Throws as open_volume and VolumeModel::field (of the first step, whose
/// method is chosen here), ArgumentError for other numbers of times, DataError where there is one step only.
VolumeSeries open_volume_series(const std::vector<std::string>& files, const VolumeModelOptions& options,
                                const std::vector<double>& times, Progress& progress);

/// When so many files are: `given` of each, or the first and the step; 0, 1, 2, … if nothing was given. Throws
/// ArgumentError for other numbers of times.
std::vector<double> times_of_series(const std::vector<double>& given, std::size_t files);

}  // namespace sansmesh::inline v1
