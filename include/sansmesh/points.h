// Jobs on points: information, normals, curvature, projection onto a surface of samples.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/attribute_table.h"
#include "sansmesh/box.h"
#include "sansmesh/cloud_options.h"
#include "sansmesh/functions.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/surface_options.h"

namespace sansmesh::inline v1 {

/// Attribute array.
struct SANSMESH_API AttributeInfo {
  std::string name;                   ///< name of the array
  std::string_view of = "point";      ///< kind of its rows: "point", "triangle" or "cell"
  NumberType type = NumberType::f32;  ///< type of its numbers
  /// Least and largest finite number of each component; empty if there is none.
  std::vector<std::optional<std::pair<double, double>>> ranges;
  std::optional<std::size_t> not_finite = {};  ///< count of numbers that are not finite; for volumes only

  static const ReportSchema& schema();  ///< report rows
};

/// Facts about a cloud or mesh. Lengths and positions in the unit of the input.
struct SANSMESH_API CloudInfo {
  std::size_t points = 0;                    ///< points or vertices
  std::size_t duplicates = 0;                ///< points that coincide with another
  Box3 box;                                  ///< bounding box of the positions
  Vec3 size;                                 ///< size of the box
  std::string spans;                         ///< "a volume", "a plane", …, or the distances between its parts
  double spacing = 0;                        ///< edge of the square that one sample represents (length)
  NoiseEstimate noise;                       ///< noise of the positions
  GivenNormals normals;                      ///< consistency of the given normals
  OrientBy orient_by = OrientBy::automatic;  ///< source of signs for new normals
  bool colors = false;                       ///< whether there are colours
  std::size_t scanners = 0;                  ///< number of known scanner positions
  std::vector<AttributeInfo> attributes;     ///< attributes of points, then of triangles
  /// Points of each class (point_class_name); empty without classes.
  std::optional<std::array<std::size_t, 256>> classes;
  std::size_t triangles = 0;         ///< triangles of the file
  std::optional<MeshTopology> mesh;  ///< topology of a mesh, sewn along coincident borders
  /// Reference system of the coordinates; null if unknown.
  std::shared_ptr<const ReferenceSystem> reference;

  static const ReportSchema& schema();  ///< report rows
};

/// Measures a cloud, or the vertices of a mesh. Throws Cancelled.
SANSMESH_API CloudInfo info(const PointSet& points, Progress& progress);

/// Options of normal estimation and orientation.
struct SANSMESH_API NormalsOptions {
  NormalOptions estimation = {};             ///< spacing and noise are measured unless given
  bool orient_only = false;                  ///< orients the given normals instead of estimating new ones
  bool orient = true;                        ///< otherwise signs are arbitrary or unchanged
  OrientBy orient_by = OrientBy::automatic;  ///< source of the signs

  static const OptionSchema& schema();  ///< option rows, one per field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Report of normals().
struct SANSMESH_API NormalsReport {
  double spacing = 0;                   ///< edge of the square that one sample represents (length)
  NoiseEstimate noise;                  ///< noise of the samples
  std::optional<int> neighbours;        ///< neighbours of each new normal
  std::optional<OrientBy> oriented_by;  ///< source of the signs
  GivenNormals check;                   ///< consistency of the result
  std::size_t unknown = 0;              ///< samples whose normal is undefined and set to zero

  static const ReportSchema& schema();  ///< report rows
};

/// Samples with normals.
struct NormalsResult {
  PointSet points;          ///< samples with normals
  NormalsReport report;     ///< how they were made
  std::vector<Note> notes;  ///< none yet
};

/// Estimates normals or uses the given ones, and orients them. Throws ArgumentError for bad options; DataError for
/// fewer than 3 distinct points, if there are no normals to orient, and if the data for `orient_by` are missing;
/// Cancelled.
SANSMESH_API NormalsResult normals(PointSet points, const NormalsOptions& options, Progress& progress);

/// Samples and origin of the normals, as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const NormalsResult& made);

/// Options of curvature estimation and colours.
struct SANSMESH_API CurvatureMapOptions {
  CurvatureQuantity color_by = CurvatureQuantity::mean;  ///< quantity shown by colours
  /// Value with the full colour (1 / length; for `gaussian` 1 / length²; > 0). Default: the 95 % quantile of the
  /// samples' absolute values.
  std::optional<double> color_range = {};
  CurvatureOptions estimation = {};  ///< noise is estimated unless given
  bool bar = true;                   ///< draws a colour bar in pictures
  std::string unit = {};             ///< unit of lengths at the bar

  static const OptionSchema& schema();  ///< option rows, one per field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Report of curvature().
struct SANSMESH_API CurvatureReport {
  CurvatureQuantity color_by = CurvatureQuantity::mean;  ///< quantity shown by colours
  bool mesh = false;                                     ///< whether curvatures are at the vertices of a mesh
  double noise = 0;           ///< standard deviation of the samples from the surface (length)
  std::size_t undefined = 0;  ///< samples with too few neighbours, whose curvatures are zero
  double q05 = 0;             ///< 5 % quantile of the shown quantity
  double median = 0;          ///< median of the shown quantity
  double q95 = 0;             ///< 95 % quantile of the shown quantity
  double color_range = 0;     ///< value with the full colour
  bool beyond_range = false;  ///< whether some values are larger

  static const ReportSchema& schema();  ///< report rows
};

/// Samples with curvatures.
struct CurvatureResult {
  /// Samples with the normals that were used, the attributes k1, k2, mean_curvature, gaussian_curvature, curvedness,
  /// shape_index and d1x to d2z (directions), and colours: red where convex, blue where concave, grey where undefined.
  /// A mesh keeps all vertices in order, and its triangles.
  PointSet points;
  CurvatureReport report;  ///< statistics
  /// On the preparation of the samples.
  std::vector<Note> notes;
};

/// Curvatures at samples, or at the vertices of a mesh: per length of the input, positive where the surface is convex.
/// Throws ArgumentError for bad options, DataError for unusable points (too few, no extent), Cancelled.
SANSMESH_API CurvatureResult curvature(PointSet points, const CurvatureMapOptions& options, Progress& progress);

/// Samples and quantiles of the shown quantity, as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const CurvatureResult& made);

/// Options of projection onto a surface of samples.
struct SANSMESH_API ProjectOptions {
  /// "auto": the recommended surface for the samples, or `curvature` if options of `surface` are set; "lop": locally
  /// optimal projection, which needs no surface; or the name of a surface.
  std::string method = "auto";
  /// Number of new, evenly spread points, made instead of moving the given ones: 1..2·10⁹. Default for lop: half the
  /// number of samples.
  std::optional<std::size_t> point_count = {};
  ProjectToSurface steps = {};  ///< projection steps
  LopOptions lop = {};          ///< `points` follows from `point_count`
  SurfaceOptions surface = {};  ///< `method` follows from `method` above
  CloudPreparation cloud = {};  ///< preparation of the samples

  /// Option rows without those of `surface` and `cloud`.
  static const OptionSchema& schema();  ///< option rows, one per field
  /// Throws ArgumentError naming the field, for values out of range and for options that do not apply to the method.
  void validate() const;
};

/// Points and the samples onto whose surface they move.
struct ProjectInput {
  PointSet points;                        ///< points to move
  std::string name = "the points";        ///< name in messages
  std::optional<PointSet> onto = {};      ///< default: the points themselves, which denoises
  std::string onto_name = "the samples";  ///< name in messages
};

/// Report of project().
struct SANSMESH_API ProjectReport {
  std::string method;  ///< name of the method that was used
  /// Distances that points moved, unless new ones were made; for lop only the count.
  SurfaceProjection moved;

  static const ReportSchema& schema();  ///< report rows
};

/// Points on a surface.
struct ProjectResult {
  PointSet points;       ///< moved or new points, with normals if the surface has them
  ProjectReport report;  ///< statistics
  /// On the preparation of the samples of the surface, with its name.
  std::vector<Note> notes;
};

/// Moves points onto the surface of samples, spreads new points on it (`points`), or consolidates them ("lop"). Throws
/// ArgumentError for bad options, DataError that begins with a name if there is no surface, or none near the points;
/// Cancelled.
SANSMESH_API ProjectResult project(ProjectInput input, const ProjectOptions& options, Progress& progress);

/// "t (double × 3 a point): 0 to 1, 2 to 3, …".
SANSMESH_API std::string array_words(const AttributeInfo& array);
/// "from (0, 0, 0) to (1, 2, 3)", to ten digits.
SANSMESH_API std::string box_words(const Box3& box);
/// All facts as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const CloudInfo& info);

}  // namespace sansmesh::inline v1
