// Internal state of a VolumeModel.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/dataset/volume_dataset.h"
#include "sansmesh/volumes.h"

namespace sansmesh::inline v1 {

struct VolumeModel::State {
  struct Made {
    ArrayChoice choice;
    std::shared_ptr<const VolumeField> field;
    std::vector<std::string> notes;
  };

  std::shared_ptr<VolumeDataset> dataset;
  std::string name;
  VolumeModelOptions options;
  ArrayChoice choice;
  std::shared_ptr<const SampledVolume> samples;
  std::optional<VolumeTraits> traits;
  VolumeReconstructionChoice recommended;
  VolumeReconstructionReport report;
  bool reported = false;
  std::vector<Made> made;

  /// Keeps the report of the first field only.
  void keep_report(const VolumeReconstructionReport& of, const VolumeReconstructionOptions& asked);
};

/// Throws as the constructors of VolumeModel.
VolumeModel model_of(VolumeDataset dataset, std::string name, const VolumeModelOptions& options = {});

inline VolumeDataset& dataset_of(const VolumeModel& volume) { return *volume.state().dataset; }

/// The given method; otherwise that of a fitted volume, or the recommended one.
VolumeReconstructionOptions options_for(const VolumeModel& volume, const std::string& array, Progress& progress);

/// Values at the samples for the ranges of isosurfaces of the field of the selected array: those of the field if it
/// smooths, the samples' own otherwise. `volume` must outlive the function.
std::function<double(std::size_t)> reconstructed_samples(const VolumeModel& volume, const VolumeField& field);

/// Range of the selected array's samples (sample_value); none without finite values.
std::optional<ValueRange> range_of_samples(const VolumeModel& volume, Progress& progress);

}  // namespace sansmesh::inline v1
