// A volume that a command reads, which of its arrays, and how that becomes a field.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "cli/report/console.h"
#include "cli/report/told_files.h"
#include "sansmesh/io/grids/read_volume.h"
#include "sansmesh/volume_look.h"
#include "sansmesh/volumes.h"

namespace sansmesh::cli {

class CommandLine;

/// A report on a volume that was read and used.
struct ReadVolume : ReadFiles {
  VolumeUse use;

  static const ReportSchema& schema();
};

struct VolumeInput : VolumeModelOptions {
  std::vector<std::string> files;  ///< at least one once the command line is read

  std::string name() const { return volume_name(files); }
  ReadFiles told() const { return {files}; }
  /// The same with what was made of it.
  ReadVolume told(VolumeModel& volume, Progress& progress) const { return {{files}, volume_use(volume, progress)}; }
  /// Warnings go to the console.
  VolumeModel open(Console& console) const;
};

/// The same, --array, and --method with its options.
void add_volume_input(CommandLine& command, VolumeInput& input);
/// --array and --method.
void add_volume_array(CommandLine& command, VolumeInput& input);
/// How raw files and those of several steps are read: --dims, --type, …
void add_raw_options(CommandLine& command, VolumeReadOptions& options);

/// Takes the word `data` away from the front of files that were given to a command of points. Returns true if it was
/// there: it says that the files are a volume.
bool says_volume(std::vector<std::string>& files);
/// Returns true if every file can be nothing but a volume, by its name or content.
bool are_volumes(const std::vector<std::string>& files);
/// Returns true if the word says so, or the files can be nothing else.
bool names_volume(std::vector<std::string>& files);

/// A surface in a volume that is named FILE[ARRAY=VALUE].
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

/// Look of a volume in a picture: --preset, --transfer, --opacity-factor and --iso.
struct VolumeColors {
  VolumePictureOptions look;  ///< its preset, opacity and iso-surfaces
  std::string transfer;       ///< a file

  /// None of the options was given.
  bool usual() const { return transfer.empty() && options_set(look).empty(); }
  /// Reads the transfer function's file. Throws FileError and ArgumentError.
  void put_into(VolumePictureOptions& options) const;
  void add_options(CommandLine& command, const char* group);
};

}  // namespace sansmesh::cli
