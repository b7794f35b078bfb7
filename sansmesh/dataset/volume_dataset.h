// A volume as loaded: files, their arrays, and the reconstructed fields.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/dataset/fitted_volume.h"
#include "sansmesh/grid_data.h"
#include "sansmesh/progress.h"
#include "sansmesh/sampled_volume.h"
#include "sansmesh/volume/grid/assemble_volume.h"
#include "sansmesh/volume/reconstruction.h"
#include "sansmesh/volume_field.h"
#include "sansmesh/volume_options.h"

namespace sansmesh::inline v1 {

class VolumeDataset {
 public:
  explicit VolumeDataset(GridData data);
  /// Has the kept arrays in the order of the file; the default is the reconstructed one.
  explicit VolumeDataset(FittedVolume fitted);

  /// Adds vectors whose components are separate arrays, as join_arrays, if `text` lists some: "vx,vy,vz", also with the
  /// ending of a choice. Returns whether there is such an array; no new ones are possible once samples are assembled.
  bool join(const std::string& text);

  const std::vector<DatasetArray>& arrays() const { return arrays_; }
  /// For a fitted volume the reconstructed array. Otherwise the first of, by preference: real with one component and
  /// not constant; one component; several components; point arrays before cell arrays. Throws DataError if there is no
  /// array.
  const DatasetArray& default_array() const;
  /// The point array, if a cell array has the same name. Throws ArgumentError that names the available arrays.
  const DatasetArray& array(const std::string& name, const std::string& option = "array") const;
  /// Throws ArgumentError that names `option` for unknown arrays and components.
  ArrayChoice choose(const std::string& text, const std::string& option = "array") const;

  /// Samples at points or in cells, assembled at the first call. Not thread-safe. Throws DataError if no samples result
  /// from the blocks.
  std::shared_ptr<const SampledVolume> volume(Association of, Progress& progress);
  /// The samples of the array.
  std::shared_ptr<const SampledVolume> volume(const std::string& array, Progress& progress);

  /// The noise of an array, estimated at the first call. `values`: volume_values() of it.
  const SampleNoise& noise(const std::string& array, const VolumeValues& values, Progress& progress);

  /// The reconstruction of an array, or of the selected part of it. Throws as reconstruct_volume. The default method is
  /// that of a fitted volume's reconstruction, otherwise choose_reconstruction selects one. If the request matches the
  /// fitted reconstruction (the same method and array, and equal values of all options set), there is no fit, and the
  /// field is bit-identical.
  std::shared_ptr<const VolumeField> field(const ArrayChoice& choice, const VolumeReconstructionOptions& options,
                                           Progress& progress, VolumeReconstructionReport* report = nullptr);

  /// Reconstructs an array with all components to be saved: keeps this array alone, or all arrays of the same samples.
  /// Throws as reconstruct_volume.
  FittedVolume fit(const std::string& array, const VolumeReconstructionOptions& options, bool all, Progress& progress,
                   VolumeReconstructionReport* report = nullptr);
  /// The fitted volume this was made from, or null.
  const FittedVolume* fitted() const { return fitted_ ? &*fitted_ : nullptr; }

  const std::string& format() const { return data_.format; }
  const std::vector<std::string>& notes() const { return data_.notes; }
  const std::vector<double>& times() const { return data_.times; }
  const std::optional<double>& time() const { return data_.time; }

 private:
  /// The reconstruction of all components; `kept` supplies or receives its coefficients.
  std::unique_ptr<VolumeField> reconstruct(const std::string& array, const VolumeReconstructionOptions& options,
                                           Progress& progress, VolumeReconstructionReport& report,
                                           ReconstructionCoefficients& kept);

  GridData data_;  ///< without blocks once they are no longer needed
  std::vector<DatasetArray> arrays_;
  std::size_t default_ = 0;
  std::array<std::shared_ptr<const SampledVolume>, 2> volumes_;
  std::optional<FittedVolume> fitted_;
  std::map<std::string, SampleNoise> noise_;  ///< arrays examined so far
};

}  // namespace sansmesh::inline v1
