// Options that several commands have, and words for the values of enumerations.
#pragma once

#include <string>
#include <vector>

#include "cli/line/command_line.h"
#include "cli/line/picture_options.h"
#include "cli/report/console.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/points/prepare_cloud.h"
#include "sansmesh/render_options.h"
#include "sansmesh/surface/curvature_words.h"

namespace sansmesh::cli {

inline constexpr const char* kReadable =
    "Reads PLY, OBJ, OFF, STL, XYZ/CSV/TXT/PWN, PCD, LAS, VTP and Stanford .conf files, gzipped or not.";

/// Throws ArgumentError with the message unless `ok`.
void require(bool ok, const char* message);

/// The places of --at, which were read as three numbers each. Throws ArgumentError unless all are finite.
std::vector<Vec3> places_at(const std::vector<double>& numbers);

/// --ascii
void add_ascii_flag(CommandLine& command, bool& ascii);
/// A mesh that a command makes, and a picture of it.
struct MeshOutput {
  std::string file, preview;
  PictureArguments picture;
  bool ascii = false;

  /// Throws FileError early if they cannot be written, ArgumentError for bad options of the picture or such without
  /// one.
  void check() const;
  /// The picture alone.
  void check_preview() const;
  /// Told as `output`. Throws FileError.
  void write(const TriangleMesh& mesh, Console& console) const;
};
/// --output, --preview, --ascii, and those of add_picture_options
void add_mesh_output(CommandLine& command, MeshOutput& output, bool required = true);
/// What is done to the samples before a fit: --faces, --normals, --orient-by, --align. (--remove-outliers belongs to
/// the group Surface.)
void add_cloud_options(CommandLine& command, CloudPreparation& use);
/// --fit, --depth, --error, --threshold, --coverage, --support, --degree, --smooth
void add_fit_options(CommandLine& command, FitOptions& options);
/// --components, --trim, --quality, --mesh-error, --triangles, …
void add_mesh_options(CommandLine& command, MeshOptions& options);

}  // namespace sansmesh::cli
