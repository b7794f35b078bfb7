// Options of several commands, and names of enumeration values.
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
    "Reads PLY, OBJ, OFF, STL, glTF, XYZ/CSV/TXT/PWN, PCD, LAS, LAZ, COPC, E57, VTP and Stanford .conf files, "
    "gzipped or not.";

/// Throws ArgumentError with the message unless `ok`.
void require(bool ok, const char* message);

/// Points of --at, given as three numbers each. Throws ArgumentError unless all are finite.
std::vector<Vec3> query_points(const std::vector<double>& numbers);

/// Adds the file of a function, as a positional argument.
void add_function_input(CommandLine& command, std::string& file);
/// Adds --output for a picture.
void add_picture_output(CommandLine& command, std::string& file);
/// Adds --output for points.
void add_points_output(CommandLine& command, std::string& file);
/// Adds --ascii.
void add_ascii_flag(CommandLine& command, bool& ascii, const std::string& group = "Options");
/// Adds --nan, which sets the values outside a volume to NaN.
void add_nan_flag(CommandLine& command, double& outside, const std::string& group = "Options");
/// Adds --unit for drawings.
void add_drawing_unit(CommandLine& command, std::string& unit, const std::string& group = "Options");
/// Mesh output of a command, with an optional picture.
struct MeshOutput {
  std::string file, preview;
  PictureArguments picture;
  bool ascii = false;

  /// Throws FileError early if the files cannot be written, ArgumentError for bad options of the picture, and for such
  /// options without a picture.
  void check() const;
  /// Checks the picture only.
  void check_preview() const;
  /// Writes and reports `output`, and the picture. Throws FileError.
  void write(const TriangleMesh& mesh, Console& console) const;
  /// Writes the picture only.
  void write_preview(const TriangleMesh& mesh, Console& console) const;
};
/// Adds --output, --preview, --ascii, and those of add_picture_options. `other`: another kind of output by its ending,
/// and its name.
struct OtherOutput {
  std::string ending, what;
};
void add_mesh_output(CommandLine& command, MeshOutput& output, bool required = true, const OtherOutput& other = {});
/// Adds options of the preparation of samples: --faces, --normals, --orient-by, --align. (--remove-outliers is in the
/// group Surface.)
void add_cloud_options(CommandLine& command, CloudPreparation& use);
/// --fit, --depth, --error, --threshold, --coverage, --support, --degree, --smooth
void add_fit_options(CommandLine& command, FitOptions& options);
/// --components, --trim, --quality, --mesh-error, --triangles, …
void add_mesh_options(CommandLine& command, MeshOptions& options);

}  // namespace sansmesh::cli
