// Files in and out. The format follows from the file's name (".ply", ".ply.gz", …) and, where that fails, its content.
// Every function throws FileError naming the file and the cause; outputs appear whole or not at all (they are written
// under a temporary name in the same folder and renamed).
#pragma once

#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/image.h"
#include "sansmesh/point_set.h"
#include "sansmesh/polyline_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// What a reader found apart from the data.
struct ReadReport {
  std::string format;                 ///< e.g. "PLY binary little endian"
  std::vector<std::string> warnings;  ///< e.g. "57,553 of 307,200 points are not finite and were left out"
  /// What the file holds besides, for which there is no place in the data: "texture coordinates". Of several files that
  /// of each, once.
  std::vector<std::string> unread;
};

/// Points of a PLY, OBJ, OFF, STL, XYZ/CSV/TXT/PWN, PCD, LAS or VTP file or of a Stanford .conf alignment
/// (several scans merged with their transforms; a scan that is not there is left out with a warning unless all are
/// missing), gzipped or not. Non-finite points are left out with a warning. Further numbers of points and faces (PLY
/// scalars, named columns of tables, PCD fields, VTP arrays of points and cells) become attributes of the type that the
/// file says; text without types: int32, or int64 or uint64 where they need it, if all are whole, else double.
///
/// LAS: the attributes are `intensity` (uint16), `return_number` and `number_of_returns` (uint8, 1 the first),
/// `classification` (uint8, the ASPRS classes of points/point_classes.h), `synthetic` and `overlap` (uint8, 1 where
/// flagged so; overlap in point formats 6 to 10), `scan_angle` (float, degrees from straight down, positive to the
/// right of the flight), `point_source_id` (uint16, flight line), `user_data` (uint8), `gps_time` (double, seconds as
/// the file counts them) and `near_infrared` (uint16), as far as the point format has them and any point has another
/// than 0; and what else the file describes (extra bytes) by the names that it gives, double where they are scaled.
/// Points flagged as withheld are left out with a warning.
///
/// Throws FileError where the file is missing, empty, truncated, malformed or holds no points.
SANSMESH_API PointSet read_points(const std::string& file, ReadReport* report = nullptr);

/// Whether there is a reader for files of that ending.
SANSMESH_API bool is_read(const std::string& file);

/// The points of several files (tiles of a survey, parts of a scan) as one cloud, in the order of the files. All have
/// one origin, that of the first file, so that a place has the same position whichever file it comes from. Attributes
/// are those of all files; where a file has one not, or of another type than the first that has it, its points' numbers
/// are unknown (NaN, or 0 of integers). Normals and colours are left out, with a warning, unless all files have them;
/// scanner positions stay, and are unknown of the points of other files. Of meshes the faces come together too. Points
/// at the same place in several files stay as they are.
/// Warnings begin with the name of their file. Throws FileError as read_points, and where some of the files have faces
/// and others have none; ArgumentError for no files at all.
SANSMESH_API PointSet read_merged(const std::vector<std::string>& files, ReadReport* report = nullptr);

/// A mesh (polygons are triangulated as fans). Throws FileError as read_points, and where the file has no faces.
SANSMESH_API TriangleMesh read_mesh(const std::string& file, ReadReport* report = nullptr);

/// The lines of a VTP file, with the attributes of their points; empty where it has none, and for files of other kinds,
/// which hold no lines. Throws FileError as read_points.
SANSMESH_API PolylineSet read_lines(const std::string& file);

struct WriteOptions {
  bool ascii = false;  ///< text instead of binary, where the format has both
};

/// Writes PLY, OBJ, STL, OFF, GLB, VTP by the name's ending. PLY and VTP hold all attributes, GLB those of vertices
/// that are 1 to 4 floats, the others none. Columns of PLY are single numbers named by one word: components become
/// name_0, name_1, …, and what would tear the header becomes '_'.
SANSMESH_API void write_mesh(const std::string& file, const TriangleMesh& mesh, const WriteOptions& options = {});

/// Writes PLY, OBJ, XYZ, CSV, PCD, VTP or LAS by the name's ending. PLY, CSV, PCD, VTP and LAS hold attributes (PLY,
/// CSV and PCD as columns, see write_mesh), the others none. Triangles are not written.
///
/// LAS: version 1.2 if its point formats hold the attributes of LAS (see read_points) that there are, else 1.4; others,
/// and those that do not fit, as extra bytes. Coordinates count decimal steps finer than the floats of the positions.
/// No normals. Throws ArgumentError for positions that are not finite.
SANSMESH_API void write_points(const std::string& file, const PointSet& points, const WriteOptions& options = {});

/// Whether there is a writer for files of that ending; kind: "mesh", "points" or "lines".
SANSMESH_API bool is_written(const std::string& file, const std::string& kind);

/// What the format of `file` has no room for, of what there is: "normals", "colours", names of attributes, "… of
/// triangles". Throws FileError where there is no writer.
SANSMESH_API std::vector<std::string> left_out(const std::string& file, const TriangleMesh& mesh);
SANSMESH_API std::vector<std::string> left_out(const std::string& file, const PointSet& points);

/// Writes VTP (lines, with all attributes), PLY (vertices and edges, with the attributes of points) or CSV (a row a
/// point: line,x,y,z and the attributes of points; `time`, where there is one, comes second) by the name's ending.
SANSMESH_API void write_lines(const std::string& file, const PolylineSet& lines, const WriteOptions& options = {});

/// Writes a PNG.
SANSMESH_API void write_image(const std::string& file, const Image& image);

/// Writes text (JSON, CSV) atomically.
SANSMESH_API void write_text(const std::string& file, const std::string& text);

/// Throws FileError early, before long work, if `file` has an ending that no writer knows (kind: "mesh", "points",
/// "lines", "image") or its folder does not exist or cannot be written.
SANSMESH_API void check_writable(const std::string& file, const std::string& kind);

}  // namespace sansmesh::inline v1
