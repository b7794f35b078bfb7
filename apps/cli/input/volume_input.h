// Volume that a command reads: its files, array and reconstruction.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cli/report/console.h"
#include "cli/report/file_reports.h"
#include "sansmesh/io/grids/read_volume.h"
#include "sansmesh/volume_look.h"
#include "sansmesh/volumes.h"

namespace sansmesh::cli {

class CommandLine;

/// Report of a volume that was read and used.
struct ReadVolume : ReadFiles {
  VolumeUse use;

  static const ReportSchema& schema();
};

struct VolumeInput : VolumeModelOptions {
  std::vector<std::string> files;  ///< not empty after parsing

  std::string name() const { return volume_name(files); }
  ReadFiles report() const { return {files}; }
  /// Also reports its use.
  ReadVolume report(VolumeModel& volume, Progress& progress) const { return {{files}, volume_use(volume, progress)}; }
  /// Warnings are sent to the console.
  VolumeModel open(Console& console) const;
};

/// Adds files, --array, and --method with its options except those in `without`.
void add_volume_input(CommandLine& command, VolumeInput& input, const std::vector<std::string_view>& without = {});
/// Adds --array and --method.
void add_volume_array(CommandLine& command, VolumeInput& input);
/// Adds options for raw files and files with several steps: --dims, --type, …
void add_raw_options(CommandLine& command, VolumeReadOptions& options);

/// Removes the leading word `data` from the files of a command for points. Returns true if it was there, which marks
/// the files as a volume.
bool take_volume_word(std::vector<std::string>& files);
/// True if the name or content of every file shows a volume.
bool are_volumes(const std::vector<std::string>& files);
/// True if the leading word `data`, or the files, indicate a volume.
bool is_volume_input(std::vector<std::string>& files);

/// Isosurface named FILE[ARRAY=VALUE].
struct NamedIsosurface {
  std::shared_ptr<const Isosurface> surface;
  VolumeUse use;
};
/// Throws FileError, DataError, and ArgumentError as VolumeDataset::choose.
NamedIsosurface open_isosurface(const IsosurfaceName& name, Console& console);

inline constexpr const char* kReadableVolumes =
    "Reads MetaImage, NRRD, raw, PLOT3D, Nek5000, meshes of Gmsh, Medit, TetGen and Vega, points with attributes and,\n"
    "through VTK, .vti .vtr .vts .vtu .vtm .vthb .vtk, Exodus, EnSight, CGNS and folders of DICOM slices; fitted\n"
    "volumes (.smv, made by volume fit).\n"
    "Several files are the blocks of one volume.";

/// Appearance of a volume in a picture: --preset, --transfer, --opacity-factor and --iso.
struct VolumeColors {
  VolumePictureOptions look;  ///< its preset, opacity and iso-surfaces
  std::string transfer;       ///< file name

  /// True if none of the options was given.
  bool is_default() const { return transfer.empty() && options_set(look).empty(); }
  /// Reads the file of the transfer function. Throws FileError and ArgumentError.
  void apply_to(VolumePictureOptions& options) const;
  void add_options(CommandLine& command, const char* group);
};

}  // namespace sansmesh::cli
