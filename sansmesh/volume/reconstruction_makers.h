// How each reconstruction is made: what the table of reconstruction.cpp calls. One source a method.
#pragma once

#include <memory>

#include "sansmesh/core/progress.h"
#include "sansmesh/data/sampled_volume.h"
#include "sansmesh/field/volume_field.h"
#include "sansmesh/volume/reconstruction_coefficients.h"
#include "sansmesh/volume/reconstruction_options.h"
#include "sansmesh/volume/volume_values.h"

namespace sansmesh {

/// What a method starts from. The factory has checked the options: in range, and none that the method does not heed.
struct ReconstructionInput {
  std::shared_ptr<const SampledVolume> volume;
  VolumeValues values;
  ReconstructionOptions options;
  Progress& progress;
  /// `options` are those above until the method puts in what it has chosen; notes about values are there already.
  ReconstructionReport& report;
  /// Methods that have some put them in here, or take those that are here already in place of a fit.
  ReconstructionCoefficients& coefficients;
};

/// Each throws ArgumentError for grids that it cannot be used on.
std::unique_ptr<VolumeField> make_nearest_field(ReconstructionInput input);
std::unique_ptr<VolumeField> make_linear_field(ReconstructionInput input);
std::unique_ptr<VolumeField> make_shepard_field(ReconstructionInput input);
std::unique_ptr<VolumeField> make_sibson_field(ReconstructionInput input);
std::unique_ptr<VolumeField> make_mean_value_field(ReconstructionInput input);
std::unique_ptr<VolumeField> make_cubic_field(ReconstructionInput input);
std::unique_ptr<VolumeField> make_sinc_field(ReconstructionInput input);
std::unique_ptr<VolumeField> make_lagrange_field(ReconstructionInput input);
std::unique_ptr<VolumeField> make_rbf_field(ReconstructionInput input);
std::unique_ptr<VolumeField> make_bernstein_field(ReconstructionInput input);
std::unique_ptr<VolumeField> make_mls_field(ReconstructionInput input);
std::unique_ptr<VolumeField> make_mls_detail_field(ReconstructionInput input);
std::unique_ptr<VolumeField> make_amls_field(ReconstructionInput input);

}  // namespace sansmesh
