// A volume with a fitted reconstruction of one array: the content of a file of a fitted volume.
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
  std::vector<DatasetArray> arrays;         ///< arrays to keep; each is in `volume` (which may have more)
  std::string array;                        ///< name of the reconstructed array, one of `arrays`
  VolumeReconstructionOptions options;      ///< options as requested; with a method
  VolumeReconstructionOptions chosen;       ///< options with the choices made from the data
  ReconstructionCoefficients coefficients;  ///< empty for methods without coefficients

  std::string source;              ///< format of the source file: "VTK XML unstructured grid"
  std::optional<double> time;      ///< time of the step
  std::vector<std::string> notes;  ///< remarks about the source file
};

}  // namespace sansmesh::inline v1
