// Contents of a file of a volume.
#pragma once

#include <memory>
#include <vector>

#include "sansmesh/jobs/volume_model.h"
#include "sansmesh/note.h"
#include "sansmesh/progress.h"
#include "sansmesh/sampled_volume.h"

namespace sansmesh::inline v1 {

struct VolumeInfo {
  std::shared_ptr<const SampledVolume> samples;  ///< with its facts; arrays and times are those of the dataset
  /// Information, what was left out or mended: "merged", "not_finite", "hidden", "overlapped", "degenerate",
  /// "inverted", "layer".
  std::vector<Note> notes;
};

/// Bare grids too, where the model may be one. Throws DataError where nothing can be made of them, Cancelled.
VolumeInfo volume_info(VolumeModel& volume, Progress& progress);

}  // namespace sansmesh::inline v1
