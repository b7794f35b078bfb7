// Field of an array of a volume.
#pragma once

#include <memory>
#include <string>

#include "sansmesh/progress.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/reconstruction_coefficients.h"
#include "sansmesh/volume/samples/sample_noise.h"
#include "sansmesh/volume/volume_method.h"
#include "sansmesh/volume_field.h"
#include "sansmesh/volume_reconstruction_options.h"

namespace sansmesh::inline v1 {

/// The field of one array (all components). `volume` is shared. Without a method choose_reconstruction selects one, and
/// the report names it with the reason. Throws ArgumentError for options out of range, options that the method does not
/// use, and grids that it does not support (naming the methods that do); DataError as volume_values.
///
/// `coefficients`: empty ones receive the fitted coefficients, if any. Others replace the fit; they must belong to the
/// same volume and array, with the options of the report of that fit. The field is then bit-identical. Smoothed samples
/// among them replace the smoothing. `noise`: noise_of_values() of the array, if it is known.
std::unique_ptr<VolumeField> reconstruct_volume(std::shared_ptr<const SampledVolume> volume, const std::string& array,
                                                const VolumeReconstructionOptions& options, Progress& progress,
                                                VolumeReconstructionReport* report = nullptr,
                                                ReconstructionCoefficients* coefficients = nullptr,
                                                const SampleNoise* noise = nullptr);

}  // namespace sansmesh::inline v1
