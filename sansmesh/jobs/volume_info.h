// Contents of a file of a volume.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/jobs/volume_model.h"
#include "sansmesh/note.h"
#include "sansmesh/points.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/sampled_volume.h"

namespace sansmesh::inline v1 {

/// The reconstruction that a fitted volume holds.
struct FittedInfo {
  std::string array;
  ReconstructionOptions options;       ///< with what was chosen from the data
  std::vector<std::size_t> by_degree;  ///< polynomials of each degree; empty of methods that have none

  static const ReportSchema& schema();
};

struct VolumeInfo {
  std::string format;
  VolumeFacts facts;
  std::size_t samples = 0;  ///< of the array, as those below
  bool in_cells = false;    ///< values are those of cells
  Box3 box;
  std::vector<AttributeInfo> arrays;
  std::optional<FittedInfo> fitted;
  std::vector<double> times;            ///< of the steps
  std::vector<std::string> file_notes;  ///< on how the file was read
  /// Information, what was left out or mended: "merged", "not_finite", "hidden", "overlapped", "degenerate",
  /// "inverted", "layer".
  std::vector<Note> notes;

  static const ReportSchema& schema();
};

/// Bare grids too, where the model may be one. Throws DataError where nothing can be made of them, Cancelled.
VolumeInfo volume_info(VolumeModel& volume, Progress& progress);

/// All of it in lines for people.
std::vector<std::string> summary_of(const VolumeInfo& info);

}  // namespace sansmesh::inline v1
