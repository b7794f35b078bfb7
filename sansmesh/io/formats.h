// Formats of files: endings, what is read of them and written to them, what their content looks like, and the functions
// that read and write points, meshes and lines.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/io.h"
#include "sansmesh/schema/registry.h"

namespace sansmesh::inline v1 {

namespace io {
struct Input;
}  // namespace io

enum class FormatId : std::uint8_t {
  // Points and meshes.
  ply,
  obj,
  off,
  stl,
  glb,
  vtp,
  pcd,
  las,
  csv,
  table,
  conf,
  // Volumes.
  metaimage,
  nrrd,
  raw,
  plot3d,
  vtk_xml,
  vtk_legacy,
  exodus,
  ensight,
  cgns,
  openfoam,
  pvd,
  series,
  dicom,
  nek_field,
  nek_series,
  gmsh,
  medit,
  tetgen,
  vega,
  // Files of this library.
  function,
  fitted_volume,
  // Pictures.
  png,
  // Known, to say what to do with them.
  laz,
  e57,
  scene,
  archive,
  added  ///< of a source of its own, here or in a program: known by its name
};

/// What a file may hold; several of them as a sum.
enum FormatContent : std::uint8_t {
  kPoints = 1,
  kMesh = 2,
  kLines = 4,
  kVolume = 8,
  kTetrahedra = 16,
  kPicture = 32,
  kFunction = 64
};

/// An ending with which files are written, and with what content.
struct WrittenAs {
  std::string_view ending = {};
  unsigned content = 0;
};

/// Data that a format can hold besides positions and triangles.
enum class FormatRoom : std::uint8_t { positions, colors, colors_and_few_floats, all_but_normals, all };

/// The bytes of a file, in parts.
using FileParts = std::vector<std::string>;

/// One format. Each is read and written by every function and command, those that a program adds
/// (`Registered<FormatInfo>`) as well.
struct FormatInfo {
  FormatId id = FormatId::added;
  std::string_view name;     ///< "PLY"
  std::string_view endings;  ///< in lower case, without dots, blanks between them; the usual one first
  unsigned reads = 0;        ///< FormatContent that is read from it
  std::array<WrittenAs, 2> written = {};
  std::string_view module = {};  ///< of its reader: "vtk"
  std::string_view remedy = {};  ///< what to do with a file that is not read
  /// Points and meshes; null where they are not read.
  PointSet (*read_points)(const io::Input& in) = nullptr;
  // Null where the format does not hold them. Arrays have the right lengths, and triangles refer to vertices.
  FileParts (*write_mesh)(const TriangleMesh& mesh, const WriteOptions& options) = nullptr;
  FileParts (*write_points)(const PointSet& points, const WriteOptions& options) = nullptr;
  FileParts (*write_lines)(const PolylineSet& lines, const WriteOptions& options) = nullptr;
  FormatRoom mesh_room = FormatRoom::all, points_room = FormatRoom::all;
  /// For formats without a FormatId: tells whether the first bytes of a file show the format beyond doubt. May be null.
  bool (*recognizes)(std::string_view bytes) = nullptr;

  /// Those of the library in the order of sansmesh/io/CMakeLists.txt, first those of FormatId in its order, then those
  /// that programs add.
  static Registry<FormatInfo>& registry();
};

/// Those of each source that has some, in the order of CMakeLists.txt, from which the definition is made.
std::vector<std::span<const FormatInfo>> own_formats();

/// All of them.
std::vector<const FormatInfo*> formats();

/// The format that reads `content` of files with such a name; of any content if that is 0; null if there is none. Two
/// formats may share an ending, for different content.
const FormatInfo* format_of_name(const std::string& file, unsigned content = 0);

/// The format that the first bytes of a file show beyond doubt, or null. Of VTK's XML files it is `vtk_xml`, whatever
/// they hold.
const FormatInfo* format_of_content(std::string_view bytes);

/// Endings with dots of all files that are read as, or written with, some of that content: {".ply", ".obj", …}.
std::vector<std::string> endings_read(unsigned content);
std::vector<std::string> endings_written(unsigned content);
/// ".ply .obj .off …" of these.
std::string listed_endings(const std::vector<std::string>& endings);

}  // namespace sansmesh::inline v1
