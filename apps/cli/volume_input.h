// A volume that a command reads, which of its arrays, and how that becomes a field.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "console.h"
#include "json.h"
#include "sansmesh/dataset/choose_reconstruction.h"
#include "sansmesh/dataset/isosurface.h"
#include "sansmesh/dataset/volume_dataset.h"
#include "sansmesh/io/read_volume.h"

namespace sansmesh::cli {

class CommandLine;

struct VolumeInput {
  std::vector<std::string> files;  ///< at least one once the command line is read
  std::string array;               ///< as given to --array; empty: the dataset's own choice
  VolumeReadOptions read;
  ReconstructionOptions method;
  bool chosen = false;       ///< the method was given
  bool may_be_bare = false;  ///< grids without any arrays are no error

  /// "a.vtu", "a.vts and 2 other files"
  std::string name() const;
  /// "file", or "files".
  Json json() const;
};

/// DATA, and what raw files need: --dims, --type, …
void add_volume_files(CommandLine& command, VolumeInput& input);
/// The same, --array, and --method with its options.
void add_volume_input(CommandLine& command, VolumeInput& input);
/// --array and --method.
void add_volume_array(CommandLine& command, VolumeInput& input);

/// A volume that was read, and fields of it. Errors of the data are thrown as FileError that name the file.
class OpenVolume {
 public:
  /// Reads; warnings go to the console.
  OpenVolume(const VolumeInput& input, Console& console);

  VolumeDataset& dataset() { return *dataset_; }
  /// What --array says, or the dataset's own choice.
  const ArrayChoice& choice() const { return choice_; }
  /// Of the files, for messages.
  std::string name() const { return input_.name(); }
  /// What to call it: the array with its component.
  std::string array_name() const;
  /// Grid, resolution and noise, and what is chosen for them: measured at the first call.
  const VolumeTraits& traits();
  const ReconstructionChoice& suited();
  /// The samples of the array.
  std::shared_ptr<const SampledVolume> samples();
  /// The reconstruction; what there is to say about it goes to the console.
  std::shared_ptr<const VolumeField> field() { return field(choice_); }
  /// The same of another array or component, with the method of the first.
  std::shared_ptr<const VolumeField> field(const ArrayChoice& choice);
  /// The same to be kept in a file, with all arrays or this alone. Throws ArgumentError where only a component of the
  /// array was chosen.
  FittedVolume fit(bool all);
  /// {f = value} of the array. Throws ArgumentError where the array has several components and none was chosen.
  std::shared_ptr<const Isosurface> isosurface(double value);
  /// A line: by which method, and why if nobody chose it.
  void say_method() const;
  const ReconstructionReport& report() const { return report_; }
  /// Value of sample i of the array as chosen (its magnitude, where a vector is asked for as a whole).
  double sample_value(std::size_t i);
  /// The middle of the range of the array, or of its component. Throws FileError where it has no finite value.
  double middle_value() const;
  /// "array", "method", "samples", "grid", …
  Json json() const;

 private:
  /// What was given; the method of a fitted volume, or the one that suits the data, where none was.
  ReconstructionOptions options_for(const std::string& array);

  const VolumeInput& input_;
  Console& console_;
  std::unique_ptr<VolumeDataset> dataset_;
  ArrayChoice choice_;
  ReconstructionReport report_;
  bool fitted_ = false;  ///< the report is of something
  std::shared_ptr<const SampledVolume> samples_;
  std::optional<VolumeTraits> traits_;
  ReconstructionChoice suited_;
};

/// Of vectors the length, unless a component is said.
ArrayChoice as_scalar(ArrayChoice choice, OpenVolume& volume);
/// The array of that name so; `field` is what errors call it.
inline ArrayChoice scalar_choice(const std::string& name, OpenVolume& volume, const char* field) {
  return as_scalar(volume.dataset().choose(name, field), volume);
}

/// How raw files and those of several steps are read: --dims, --type, …
void add_raw_options(CommandLine& command, VolumeReadOptions& options);

/// Whether files that were given to a command of points are a volume: the word `data` before them says so (and is taken
/// away), or that they can be nothing else.
bool names_volume(std::vector<std::string>& files);

/// A surface in a volume that is named FILE[ARRAY=VALUE].
struct NamedIsosurface {
  std::shared_ptr<const Isosurface> surface;
  Json json;
};
/// Throws FileError, and ArgumentError as VolumeDataset::choose.
NamedIsosurface open_isosurface(const IsosurfaceName& name, Console& console);

inline constexpr const char* kReadableVolumes =
    "Reads MetaImage, NRRD, raw, PLOT3D, Nek5000, meshes of Gmsh, Medit, TetGen and Vega, points with attributes and,\n"
    "through VTK, .vti .vtr .vts .vtu .vtm .vthb .vtk, Exodus, EnSight, CGNS and folders of DICOM slices; fitted\n"
    "volumes (.smv, made by volume fit).\n"
    "Several files are the blocks of one volume.";

}  // namespace sansmesh::cli
