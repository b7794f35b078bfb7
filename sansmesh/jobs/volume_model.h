// A volume that is open: its arrays, the one that is looked at, and the reconstruction that makes fields of them.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/dataset/isosurface.h"
#include "sansmesh/dataset/volume_dataset.h"
#include "sansmesh/error.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/volume/choose_reconstruction.h"
#include "sansmesh/volume_read_options.h"

namespace sansmesh::inline v1 {

struct VolumeModelOptions {
  /// "NAME", "NAME:0", "NAME:x" or "NAME:magnitude"; empty: the dataset's own choice, a scalar where there is one.
  std::string array = {};
  ReconstructionOptions reconstruction = {};
  VolumeReadOptions read = {};
  bool bare = false;  ///< grids without any arrays are no error

  /// Without `bare`, which jobs decide.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// A volume as it was used.
struct VolumeUse {
  std::string format, array;
  std::string method, why;  ///< of reconstruction, and the reason if the library chose it; empty without one
  std::size_t samples = 0;
  std::string grid;                ///< in words
  std::vector<std::string> notes;  ///< on the values

  static const ReportSchema& schema();
};

/// Fields are made when they are asked for, and kept. Not safe from several threads. Errors of the data are thrown as
/// DataError that begins with the name; ArgumentError names options. What there is to say of a field is added to
/// `notes` with the code "reconstruction", at every call.
class VolumeModel {
 public:
  /// `name` stands in messages: the file. Throws ArgumentError for bad options, DataError where there are no arrays.
  VolumeModel(VolumeDataset dataset, std::string name, const VolumeModelOptions& options = {});

  const std::string& name() const { return name_; }
  const VolumeModelOptions& options() const { return options_; }
  VolumeDataset& dataset() { return dataset_; }
  const VolumeDataset& dataset() const { return dataset_; }
  /// Calls; errors of the data get the name in front.
  template <class Call>
  auto naming(Call call) const {
    return with_name(name_, call);
  }
  /// Of the files, with the code "volume".
  std::vector<Note> notes() const;
  /// What `array` says, or the dataset's own choice; of a bare grid no name.
  const ArrayChoice& choice() const { return choice_; }
  const DatasetArray& array() const { return dataset_.array(choice_.array); }
  /// What to call it: the array with its component, "V_0", "V_magnitude".
  std::string array_name() const;
  /// All components of several, none chosen.
  bool is_vector() const;
  /// The same; of vectors the length, unless a component is chosen.
  ArrayChoice as_scalar(ArrayChoice choice) const;
  /// The array of that name so; `field` is what errors call it.
  ArrayChoice scalar_choice(const std::string& name, const std::string& field) const;

  /// The samples of the array.
  std::shared_ptr<const SampledVolume> samples(Progress& progress);
  /// What its values are like, and what is chosen for them: measured at the first call.
  const VolumeTraits& traits(Progress& progress);
  const ReconstructionChoice& suited(Progress& progress);

  /// The reconstruction of the array, or of another one (or component) with the method of this.
  std::shared_ptr<const VolumeField> field(Progress& progress, std::vector<Note>& notes);
  std::shared_ptr<const VolumeField> field(const ArrayChoice& choice, Progress& progress, std::vector<Note>& notes);
  /// The same to be kept in a file, with all arrays or this alone. Throws ArgumentError where only a component of the
  /// array was chosen.
  FittedVolume fit(bool all, Progress& progress, std::vector<Note>& notes);
  /// {f = value} of the array. Throws ArgumentError where the array has several components and none was chosen.
  std::shared_ptr<const Isosurface> isosurface(double value, Progress& progress, std::vector<Note>& notes);
  /// Of the first field that was made: by which method, and why if the library chose it.
  const ReconstructionReport& report() const { return report_; }
  /// All of that with its samples.
  VolumeUse use(Progress& progress);

  /// Value of sample i of the array as chosen (its magnitude, where a vector is asked for as a whole). Samples must
  /// have been asked for.
  double sample_value(std::size_t i) const;
  /// The middle of the range of the array, or of its component. Throws DataError where it has no finite value.
  double middle_value() const;
  /// The value, or the middle of the range. Throws ArgumentError for vectors, whose lengths have none.
  double value_or_middle(const std::optional<double>& value) const;
  /// Throws ArgumentError where the array has several components and none was chosen.
  void check_scalar() const;

 private:
  struct Made {
    ArrayChoice choice;
    std::shared_ptr<const VolumeField> field;
    std::vector<std::string> notes;
  };
  /// What was given; the method of a fitted volume, or the one that suits the data, where none was.
  ReconstructionOptions options_for(const std::string& array, Progress& progress);
  void keep_report(const ReconstructionReport& report, const ReconstructionOptions& asked);

  VolumeDataset dataset_;
  std::string name_;
  VolumeModelOptions options_;
  ArrayChoice choice_;
  std::shared_ptr<const SampledVolume> samples_;
  std::optional<VolumeTraits> traits_;
  ReconstructionChoice suited_;
  ReconstructionReport report_;
  bool reported_ = false;
  std::vector<Made> made_;
};

/// Reads a volume; several files are its blocks. Throws FileError, ArgumentError for bad options, those of raw files
/// with a fitted volume among them, and DataError where there are no arrays.
VolumeModel open_volume(const std::vector<std::string>& files, const VolumeModelOptions& options, Progress& progress);

/// "a.vtu", "a.vts and 2 other files".
std::string volume_name(const std::vector<std::string>& files);

}  // namespace sansmesh::inline v1
