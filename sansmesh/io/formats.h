// Registry of file formats: endings, content, signatures, and functions that read and write points, meshes and lines.
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
  laz,
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
  // Recognised only to explain what to do with them.
  e57,
  scene,
  archive,
  added  ///< identified by its name: registered by a source of the library or by a program
};

/// Content of a file; combined by addition.
enum FormatContent : std::uint8_t {
  kPoints = 1,
  kMesh = 2,
  kLines = 4,
  kVolume = 8,
  kTetrahedra = 16,
  kPicture = 32,
  kFunction = 64
};

/// An ending for writing, with the content that is written.
struct WrittenAs {
  std::string_view ending = {};
  unsigned content = 0;
};

/// Data that a format can hold besides positions and triangles.
enum class FormatCapacity : std::uint8_t { positions, colors, colors_and_few_floats, all_but_normals, all };

/// How a format holds a reference system: in a file .prj beside it, as a line of text (WKT or an EPSG code), or in
/// records of LAS (also GeoTIFF keys), of which programs may read WKT only (octrees).
enum class SystemCapacity : std::uint8_t { beside, text, records, records_of_text };

/// The bytes of a file, in parts.
using FileParts = std::vector<std::string>;

/// One format. Every function and command uses all registered formats, including those that a program adds
/// (`Registered<FormatInfo>`).
struct FormatInfo {
  FormatId id = FormatId::added;
  std::string_view name;     ///< for example "PLY"
  std::string_view endings;  ///< in lower case, without dots, separated by blanks; the usual one first
  unsigned reads = 0;        ///< FormatContent that can be read
  std::array<WrittenAs, 2> written = {};
  std::string_view module = {};  ///< module of its reader, for example "vtk"
  std::string_view remedy = {};  ///< advice for files that cannot be read
  /// Reads points and meshes; null if the format has no such reader.
  PointSet (*read_points)(const io::Input& in) = nullptr;
  bool selects = false;  ///< `read_points` applies the box of `in.options` itself; its result may be empty
  // Null if the format does not hold the content. Arrays have the right lengths, and triangles refer to existing
  // vertices.
  FileParts (*write_mesh)(const TriangleMesh& mesh, const WriteOptions& options) = nullptr;
  FileParts (*write_points)(const PointSet& points, const WriteOptions& options) = nullptr;
  FileParts (*write_lines)(const PolylineSet& lines, const WriteOptions& options) = nullptr;
  FormatCapacity mesh_capacity = FormatCapacity::all, points_capacity = FormatCapacity::all;
  SystemCapacity system_capacity = SystemCapacity::beside;
  /// For formats without a FormatId: whether the first bytes of a file identify the format beyond doubt. May be null.
  bool (*recognizes)(std::string_view bytes) = nullptr;

  /// The library's formats in the order of FormatId, then other formats of the library, then those that programs add.
  static Registry<FormatInfo>& registry();
};

/// Formats of each source that has some, in the order of CMakeLists.txt, from which the definition is generated.
std::vector<std::span<const FormatInfo>> own_formats();

/// All registered formats.
std::vector<const FormatInfo*> formats();

/// The format that reads `content` from files with such a name (0: any content); null if there is none. Two formats may
/// share an ending for different content.
const FormatInfo* format_of_name(const std::string& file, unsigned content = 0);

/// The format that the first bytes of a file identify beyond doubt, or null. For VTK's XML files it is `vtk_xml`,
/// whatever they contain.
const FormatInfo* format_of_content(std::string_view bytes);

/// Endings with dots of all files that are read or written with some of the content: {".ply", ".obj", …}.
std::vector<std::string> endings_read(unsigned content);
std::vector<std::string> endings_written(unsigned content);
/// The same as text: ".ply .obj .off …".
std::string listed_endings(const std::vector<std::string>& endings);

}  // namespace sansmesh::inline v1
