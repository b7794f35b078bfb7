// Reads and writes clouds, meshes, lines, images and text. The format follows from the file's suffix (".ply",
// ".ply.gz", …); readers also inspect the content if the suffix is unknown. Every function throws FileError, which
// names the file and the cause. Outputs are atomic: they are written under a temporary name in the same folder and then
// renamed.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/image.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/polyline_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Format, warnings and omissions of a reader.
struct ReadReport {
  std::string format;                 ///< e.g. "PLY binary little endian"
  std::vector<std::string> warnings;  ///< e.g. "57,553 of 307,200 points are not finite and were left out"
  /// Contents of the file that the data cannot hold, each listed once: "texture coordinates".
  std::vector<std::string> unread;
  /// Reference system that the file, or a .prj file beside it, states; null if unknown.
  std::shared_ptr<const ReferenceSystem> reference;
};

/// The part of a cloud to read.
struct ReadOptions {
  /// Only points in this box, in the coordinates of the file. Readers of LAS, LAZ and COPC apply it while they read.
  std::optional<Box3> box = {};
  /// COPC: the distance of neighbouring points that is needed, in the unit of the file. Levels of the octree beyond the
  /// first with at most this distance are left out. Other formats have no levels; a warning states that.
  std::optional<double> resolution = {};

  static const OptionSchema& schema();  ///< one row per field
};

/// Reads the points of a PLY, OBJ, OFF, STL, GLB or glTF, XYZ/CSV/TXT/PWN, PCD, LAS, LAZ (also COPC) or VTP file, or of
/// a Stanford .conf alignment (several scans merged with their transforms; a missing scan is left out with a warning
/// unless all are missing), gzipped or not. Points that are not finite are left out with a warning. Further numbers of
/// points and faces (PLY scalars, named columns of tables, PCD fields, VTP arrays of points and cells) become
/// attributes of the type in the file. Columns of text without types become int32 if all numbers are integers (int64 or
/// uint64 if necessary), else double.
///
/// LAS: the attributes are `intensity` (uint16), `return_number` and `number_of_returns` (uint8, 1 is the first),
/// `classification` (uint8, the ASPRS classes of sansmesh/cloud_options.h), `synthetic` and `overlap` (uint8, 1 if
/// flagged; overlap in point formats 6 to 10), `scan_angle` (float, degrees from straight down, positive to the right
/// of the flight), `point_source_id` (uint16, flight line), `user_data` (uint8), `gps_time` (double, seconds in the
/// file's time base) and `near_infrared` (uint16). An attribute is present if the point format has it and any value
/// differs from 0. Extra bytes have the names in the file, and are double if they are scaled. Points flagged as
/// withheld are left out with a warning.
///
/// Throws FileError if the file is missing, empty, truncated, malformed or holds no points, also if none is in the box
/// of the options.
SANSMESH_API PointSet read_points(const std::string& file, ReadReport* report = nullptr,
                                  const ReadOptions& options = {});

/// Whether a reader of clouds and meshes exists for the suffix of that file.
SANSMESH_API bool is_read(const std::string& file);

/// Reads several files (tiles of a survey, parts of a scan) as one cloud, in the order of the files. Names may be
/// folders (their files of one format, in the order of names), patterns ("tiles/*.las") and lists of files (ending
/// .lst, .list or .txt, a name per line). A file that is named twice is read once. All positions refer to one origin,
/// that of a file with all points. The attributes are those of all files; if a file lacks one, or has it with another
/// type than the first file that has it, the values of its points are unknown (NaN, or 0 for integers). Normals and
/// colours are left out, with a warning, unless all files have them. Scanner positions are kept, and are unknown for
/// points of files without them. Faces of meshes are kept. Coincident points of different files are all kept. Warnings
/// begin with the name of their file. Files without points in the box of the options are left out. Throws FileError as
/// read_points, and if only some of the files have faces; ArgumentError if there are no files.
SANSMESH_API PointSet read_merged(const std::vector<std::string>& files, ReadReport* report = nullptr,
                                  const ReadOptions& options = {});

/// Reads a mesh; polygons are triangulated as fans. Throws FileError as read_points, and if the file has no faces.
SANSMESH_API TriangleMesh read_mesh(const std::string& file, ReadReport* report = nullptr);

/// Reads the lines of a VTP file, with the attributes of their points, those of an OBJ file, or the LINE, POLYLINE and
/// LWPOLYLINE entities of a text DXF file. Empty if there are none, and for files of other formats. Throws FileError as
/// read_points.
SANSMESH_API PolylineSet read_lines(const std::string& file, ReadReport* report = nullptr);

/// Options of writers.
struct WriteOptions {
  bool ascii = false;  ///< text instead of binary, if the format has both
};

/// Writes PLY, OBJ, STL, OFF, GLB or VTP, by the suffix. PLY and VTP hold all attributes, GLB those of vertices with 1
/// to 4 floats, the other formats none. PLY properties are single numbers named by one word: components become name_0,
/// name_1, …, and characters that would break the header become '_'.
SANSMESH_API void write_mesh(const std::string& file, const TriangleMesh& mesh, const WriteOptions& options = {});

/// Writes PLY, OBJ, XYZ, CSV, PCD, VTP or LAS, by the suffix. PLY, CSV, PCD, VTP and LAS hold attributes (PLY, CSV and
/// PCD as columns, see write_mesh), the others none. Triangles are not written.
///
/// LAS: version 1.2 if its point formats hold the LAS attributes of the cloud (see read_points), else 1.4. Other
/// attributes, and values out of range, become extra bytes. Coordinates are multiples of a decimal step finer than the
/// floats of the positions. Normals are not written. Throws ArgumentError for positions that are not finite.
SANSMESH_API void write_points(const std::string& file, const PointSet& points, const WriteOptions& options = {});

/// Whether a writer exists for the suffix of that file; kind: "mesh", "points" or "lines".
SANSMESH_API bool is_written(const std::string& file, const std::string& kind);

/// Parts of the mesh that the format of `file` cannot hold: "normals", "colours", names of attributes, "… of
/// triangles". Throws FileError if there is no writer.
SANSMESH_API std::vector<std::string> left_out(const std::string& file, const TriangleMesh& mesh);
/// Same, for a cloud.
SANSMESH_API std::vector<std::string> left_out(const std::string& file, const PointSet& points);

/// Writes VTP (lines, with all attributes), PLY (vertices and edges, with the attributes of points) or CSV (one row per
/// point: line, time if present, x, y, z and the other attributes of points), by the suffix.
SANSMESH_API void write_lines(const std::string& file, const PolylineSet& lines, const WriteOptions& options = {});

/// Writes a PNG with 8 bits per channel; values outside 0..1 are clamped. Throws ArgumentError if the number of pixels
/// is 0 or not width · height; FileError for a suffix other than .png.
SANSMESH_API void write_image(const std::string& file, const Image& image);

/// Writes a GeoTIFF (.tif) of float32 with the reference system; −9999 where heights are unknown. Throws ArgumentError
/// if there are no cells; FileError for other suffixes, and beyond 4 GB.
SANSMESH_API void write_height_grid(const std::string& file, const HeightGrid& grid);

/// Writes text (JSON, CSV) unchanged.
SANSMESH_API void write_text(const std::string& file, const std::string& text);

/// Throws FileError before long work if no writer knows the suffix of `file` (kind: "mesh", "points", "lines",
/// "image"), or if its folder does not exist or cannot be written.
SANSMESH_API void check_writable(const std::string& file, const std::string& kind);

}  // namespace sansmesh::inline v1
