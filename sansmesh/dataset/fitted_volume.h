// A volume with a reconstruction of one of its arrays that needs no fit any more: what files of fitted volumes hold.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/reconstruction_coefficients.h"
#include "sansmesh/volume_options.h"

namespace sansmesh::inline v1 {

struct FittedVolume {
  std::shared_ptr<const SampledVolume> volume;
  std::vector<DatasetArray> arrays;         ///< that are kept, each one of `volume` (which may have more)
  std::string array;                        ///< the one that was reconstructed, one of them
  ReconstructionOptions options;            ///< as they were asked for; with a method
  ReconstructionOptions chosen;             ///< with what was chosen from the data
  ReconstructionCoefficients coefficients;  ///< empty for methods that have none

  std::string source;              ///< format of the file that it was made of: "VTK XML unstructured grid"
  std::optional<double> time;      ///< of the step
  std::vector<std::string> notes;  ///< what a user should know of that file
};

}  // namespace sansmesh::inline v1
