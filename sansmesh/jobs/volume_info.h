// Contents of a file of a volume.
#pragma once

#include <memory>
#include <vector>

#include "sansmesh/core/note.h"
#include "sansmesh/core/progress.h"
#include "sansmesh/data/sampled_volume.h"
#include "sansmesh/jobs/volume_model.h"

namespace sansmesh {

struct VolumeInfo {
  std::shared_ptr<const SampledVolume> samples;  ///< with its facts; arrays and times are those of the dataset
  /// Information, what was left out or mended: "merged", "not_finite", "hidden", "overlapped", "degenerate",
  /// "inverted", "layer".
  std::vector<Note> notes;
};

/// Bare grids too, where the model may be one. Throws DataError where nothing can be made of them, Cancelled.
VolumeInfo volume_info(VolumeModel& volume, Progress& progress);

}  // namespace sansmesh
