// Every format of files, in one table: its endings, what is read of it and written to it, and what its content looks
// like.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sansmesh {

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
  archive
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

struct FormatInfo {
  FormatId id;
  std::string_view name;     ///< "PLY"
  std::string_view endings;  ///< in lower case, without dots, blanks between them; the usual one first
  unsigned reads = 0;        ///< FormatContent that is read from it
  std::array<WrittenAs, 2> written = {};
  std::string_view module = {};  ///< of its reader: "vtk"
  std::string_view remedy = {};  ///< what to do with a file that is not read
};

/// In the order of FormatId.
std::span<const FormatInfo> formats();
const FormatInfo& format_info(FormatId id);

/// The format that reads `content` of files with such a name; of any content if that is 0. Two formats may share an
/// ending, for different content.
std::optional<FormatId> format_of_name(const std::string& file, unsigned content = 0);

/// The format that the first bytes of a file show beyond doubt. Of VTK's XML files it is `vtk_xml`, whatever they hold.
std::optional<FormatId> format_of_content(std::string_view bytes);

/// Endings with dots of all files that are read as, or written with, some of that content: {".ply", ".obj", …}.
std::vector<std::string> endings_read(unsigned content);
std::vector<std::string> endings_written(unsigned content);

}  // namespace sansmesh
