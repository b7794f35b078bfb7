// A volume as a user has it: some files, their arrays, and the fields that reconstructions make of these.
#pragma once

#include <array>
#include <cstddef>
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
  /// Has the arrays that are kept; their order is the file's, the default is the one that was reconstructed.
  explicit VolumeDataset(FittedVolume fitted);

  const std::vector<DatasetArray>& arrays() const { return arrays_; }
  /// That of a fitted volume; else the first real array of one component that is not constant; else of one component,
  /// else of several, and then of points rather than of cells. Throws DataError where there is no array at all.
  const DatasetArray& default_array() const;
  /// Of points, where there are two of that name. Throws ArgumentError naming those that there are.
  const DatasetArray& array(const std::string& name, const std::string& option = "array") const;
  /// Throws ArgumentError, which names `option`, for names of no array and components that it has not.
  ArrayChoice choose(const std::string& text, const std::string& option = "array") const;

  /// Samples at points or in cells: assembled at the first call. Not safe from several threads. Throws DataError where
  /// nothing can be made of the blocks.
  std::shared_ptr<const SampledVolume> volume(Association of, Progress& progress);
  /// Those that the array belongs to.
  std::shared_ptr<const SampledVolume> volume(const std::string& array, Progress& progress);

  /// The reconstruction of an array, of all its components or of what was chosen. Throws as reconstruct_volume. Without
  /// a method it is the one that a fitted volume holds, or else suits the array (choose_reconstruction). Where that is
  /// the reconstruction that a fitted volume holds (the same method and array, and whatever is set the same as what it
  /// was made with), nothing is fitted, and the field is the same to the bit.
  std::shared_ptr<const VolumeField> field(const ArrayChoice& choice, const ReconstructionOptions& options,
                                           Progress& progress, ReconstructionReport* report = nullptr);

  /// Reconstructs an array with all its components, to be kept in a file: that array alone, or all that belong to the
  /// same samples. Throws as reconstruct_volume.
  FittedVolume fit(const std::string& array, const ReconstructionOptions& options, bool all, Progress& progress,
                   ReconstructionReport* report = nullptr);
  /// What it was made of, if that is a fitted volume.
  const FittedVolume* fitted() const { return fitted_ ? &*fitted_ : nullptr; }

  const std::string& format() const { return data_.format; }
  const std::vector<std::string>& notes() const { return data_.notes; }
  const std::vector<double>& times() const { return data_.times; }
  const std::optional<double>& time() const { return data_.time; }

 private:
  /// The reconstruction of all components; `kept` receives or gives its coefficients.
  std::unique_ptr<VolumeField> reconstruct(const std::string& array, const ReconstructionOptions& options,
                                           Progress& progress, ReconstructionReport& report,
                                           ReconstructionCoefficients& kept);

  GridData data_;  ///< without blocks once nothing more can be made of them
  std::vector<DatasetArray> arrays_;
  std::size_t default_ = 0;
  std::array<std::shared_ptr<const SampledVolume>, 2> volumes_;
  std::optional<FittedVolume> fitted_;
};

}  // namespace sansmesh::inline v1
