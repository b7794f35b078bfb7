// A volume that a command reads, which of its arrays, and how that becomes a field.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "console.h"
#include "json.h"
#include "sansmesh/io/read_volume.h"
#include "sansmesh/jobs/volume_model.h"

namespace sansmesh::cli {

class CommandLine;

struct VolumeInput : VolumeModelOptions {
  std::vector<std::string> files;  ///< at least one once the command line is read

  std::string name() const { return volume_name(files); }
  /// "file", or "files".
  Json json() const;
  /// Warnings go to the console.
  VolumeModel open(Console& console) const;
};

/// DATA, and what raw files need: --dims, --type, …
void add_volume_files(CommandLine& command, VolumeInput& input);
/// The same, --array, and --method with its options.
void add_volume_input(CommandLine& command, VolumeInput& input);
/// --array and --method.
void add_volume_array(CommandLine& command, VolumeInput& input);
/// How raw files and those of several steps are read: --dims, --type, …
void add_raw_options(CommandLine& command, VolumeReadOptions& options);

/// A line: by which method, and why if nobody chose it.
std::string method_line(const VolumeModel& volume);
/// "array", "method", "samples", "grid", …
Json json_of_volume(const VolumeInput& input, VolumeModel& volume, Progress& progress);

/// A volume whose notes are printed as they come. Errors of the data are FileErrors.
class OpenVolume {
 public:
  OpenVolume(const VolumeInput& input, Console& console);

  VolumeModel& model() { return model_; }
  VolumeDataset& dataset() { return model_.dataset(); }
  const ArrayChoice& choice() const { return model_.choice(); }
  std::string name() const { return model_.name(); }
  std::string array_name() const { return model_.array_name(); }
  std::shared_ptr<const SampledVolume> samples();
  std::shared_ptr<const VolumeField> field() { return field(choice()); }
  std::shared_ptr<const VolumeField> field(const ArrayChoice& choice);
  std::shared_ptr<const Isosurface> isosurface(double value);
  void say_method() const { console_.say(method_line(model_)); }
  const ReconstructionReport& report() const { return model_.report(); }
  double sample_value(std::size_t i) const { return model_.sample_value(i); }
  Json json() { return json_of_volume(input_, model_, console_.progress()); }

 private:
  const VolumeInput& input_;
  Console& console_;
  VolumeModel model_;
};

/// Of vectors the length, unless a component is said.
inline ArrayChoice as_scalar(const ArrayChoice& choice, OpenVolume& volume) { return volume.model().as_scalar(choice); }
/// The array of that name so; `field` is what errors call it.
inline ArrayChoice scalar_choice(const std::string& name, OpenVolume& volume, const char* field) {
  return volume.model().scalar_choice(name, field);
}

/// Whether files that were given to a command of points are a volume: the word `data` before them says so (and is taken
/// away), or that they can be nothing else.
bool names_volume(std::vector<std::string>& files);

/// A surface in a volume that is named FILE[ARRAY=VALUE].
struct NamedIsosurface {
  std::shared_ptr<const Isosurface> surface;
  Json json;
};
/// Throws FileError, DataError, and ArgumentError as VolumeDataset::choose.
NamedIsosurface open_isosurface(const IsosurfaceName& name, Console& console);

inline constexpr const char* kReadableVolumes =
    "Reads MetaImage, NRRD, raw, PLOT3D, Nek5000, meshes of Gmsh, Medit, TetGen and Vega, points with attributes and,\n"
    "through VTK, .vti .vtr .vts .vtu .vtm .vthb .vtk, Exodus, EnSight, CGNS and folders of DICOM slices; fitted\n"
    "volumes (.smv, made by volume fit).\n"
    "Several files are the blocks of one volume.";

}  // namespace sansmesh::cli
