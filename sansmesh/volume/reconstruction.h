// Field of an array of a volume.
#pragma once

#include <memory>
#include <string>

#include "sansmesh/progress.h"
#include "sansmesh/reconstruction_options.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/reconstruction_coefficients.h"
#include "sansmesh/volume/volume_method.h"
#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

/// The field of one array (all its components). `volume` is shared. Without a method the one that suits the array is
/// chosen (choose_reconstruction), and the report says which and why. Throws ArgumentError for options out of range,
/// that the method does not use, or a grid that it cannot be used on (naming those that can), DataError as
/// volume_values.
///
/// `coefficients`: those that are empty receive what the method has fitted, if anything. Others are taken in place of a
/// fit, and must be those of the same volume and array, with the options that the report told then: the field is the
/// same to the bit.
std::unique_ptr<VolumeField> reconstruct_volume(std::shared_ptr<const SampledVolume> volume, const std::string& array,
                                                const ReconstructionOptions& options, Progress& progress,
                                                ReconstructionReport* report = nullptr,
                                                ReconstructionCoefficients* coefficients = nullptr);

}  // namespace sansmesh::inline v1
