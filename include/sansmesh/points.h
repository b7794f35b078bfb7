// Jobs on points: information, normals, curvature, projection onto the surface of samples.
#pragma once

#include <array>
#include <cstddef>
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

/// One array of attributes.
struct SANSMESH_API AttributeInfo {
  std::string name;                   ///< of the array
  std::string_view of = "point";      ///< of what it has rows: "point", "triangle" or "cell"
  NumberType type = NumberType::f32;  ///< of its numbers
  /// For each component the least and the largest finite number; nothing where there is none.
  std::vector<std::optional<std::pair<double, double>>> ranges;
  std::optional<std::size_t> not_finite = {};  ///< numbers; told of arrays of volumes

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Facts of a cloud or mesh. Lengths and places in the unit of the input.
struct SANSMESH_API CloudInfo {
  std::size_t points = 0;                    ///< or vertices
  std::size_t duplicates = 0;                ///< in the place of another
  Box3 box;                                  ///< around the positions
  Vec3 size;                                 ///< of the box
  std::string spans;                         ///< "a volume", "a plane", …, or how far its parts are apart
  double spacing = 0;                        ///< edge of the square that one sample stands for (length)
  NoiseEstimate noise;                       ///< of the positions
  GivenNormals normals;                      ///< how the given normals point
  OrientBy orient_by = OrientBy::automatic;  ///< from what normals would get their signs
  bool colors = false;                       ///< there are some
  std::size_t scanners = 0;                  ///< whose positions are known
  std::vector<AttributeInfo> attributes;     ///< of points, then of triangles
  /// Points of each class (point_class_name); nothing where they have none.
  std::optional<std::array<std::size_t, 256>> classes;
  std::size_t triangles = 0;         ///< of the file
  std::optional<MeshTopology> mesh;  ///< of what has some, sewn where its borders lie on each other

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Measures a cloud, or the vertices of a mesh. Throws Cancelled.
SANSMESH_API CloudInfo info(const PointSet& points, Progress& progress);

/// Whether to estimate normals, and to give them signs.
struct SANSMESH_API NormalsOptions {
  NormalOptions estimation = {};             ///< its spacing and noise are measured where they are not given
  bool orient_only = false;                  ///< orient the given normals instead of estimating new ones
  bool orient = true;                        ///< otherwise signs stay as they come
  OrientBy orient_by = OrientBy::automatic;  ///< from what the signs are taken

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Numbers of a run of normals().
struct SANSMESH_API NormalsReport {
  double spacing = 0;                   ///< edge of the square that one sample stands for (length)
  NoiseEstimate noise;                  ///< of the samples
  std::optional<int> neighbours;        ///< of new normals
  std::optional<OrientBy> oriented_by;  ///< from what the signs were taken
  GivenNormals check;                   ///< of what was made
  std::size_t unknown = 0;              ///< samples without a normal: zero

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Samples with normals.
struct NormalsResult {
  PointSet points;          ///< with normals
  NormalsReport report;     ///< how they were made
  std::vector<Note> notes;  ///< there are none yet
};

/// Estimates normals, or keeps those there are, and gives them signs. Throws ArgumentError for bad options; DataError
/// for fewer than 3 different points, none to keep, and where nothing
/// is known of what `orient_by` asks for; Cancelled.
SANSMESH_API NormalsResult normals(PointSet points, const NormalsOptions& options, Progress& progress);

/// What the samples are like, and where the normals come from, in lines for people.
SANSMESH_API std::vector<std::string> summary_of(const NormalsResult& made);

/// What is measured, and what the colours show.
struct SANSMESH_API CurvatureMapOptions {
  CurvatureQuantity color_by = CurvatureQuantity::mean;  ///< what the colours show
  /// The value that gets the full colour (1 / length, of `gaussian` 1 / length²; > 0). Default: that exceeded by one
  /// sample in twenty.
  std::optional<double> color_range = {};
  CurvatureOptions estimation = {};  ///< its noise is estimated where it is not given
  bool bar = true;                   ///< in pictures: a colour bar
  std::string unit = {};             ///< of lengths, at the bar

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Numbers of a run of curvature().
struct SANSMESH_API CurvatureReport {
  CurvatureQuantity color_by = CurvatureQuantity::mean;  ///< as used
  bool mesh = false;                                     ///< the curvatures are those of a mesh's vertices
  double noise = 0;                                      ///< standard deviation of the samples off the surface (length)
  std::size_t undefined = 0;                             ///< samples without enough neighbours: zero
  double q05 = 0;                                        ///< 5 % quantile of the quantity that is shown
  double median = 0;                                     ///< of the quantity that is shown
  double q95 = 0;                                        ///< 95 % quantile of the quantity that is shown
  double color_range = 0;                                ///< the value that gets the full colour
  bool beyond_range = false;                             ///< some are larger

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Samples with curvatures.
struct CurvatureResult {
  /// With the normals that were used, the attributes k1, k2, mean_curvature, gaussian_curvature, curvedness,
  /// shape_index and d1x to d2z (directions), and with colours: red where convex, blue where concave, grey where not
  /// defined. Of a mesh all vertices in their order, and its triangles.
  PointSet points;
  CurvatureReport report;  ///< what they are like
  /// "preparation": what there is to say of the samples.
  std::vector<Note> notes;
};

/// Curvatures at samples, or at the vertices of a mesh: per length of the input, positive where the surface is convex.
/// Throws ArgumentError for bad options, DataError where the points cannot be used (too few, no extent), Cancelled.
SANSMESH_API CurvatureResult curvature(PointSet points, const CurvatureMapOptions& options, Progress& progress);

/// Samples, and quantiles of the quantity that is shown, in lines for people.
SANSMESH_API std::vector<std::string> summary_of(const CurvatureResult& made);

/// Onto which surface points move, or how many new ones are made.
struct SANSMESH_API ProjectOptions {
  /// "auto": what suits the samples, or `curvature` where options of `surface` are set; "lop": consolidation of the
  /// points, without a surface; or the name of a surface.
  std::string method = "auto";
  /// So many new points, spread evenly, instead of moving those given: 1..2·10⁹. Of lop half as many as there are by
  /// default.
  std::optional<std::size_t> point_count = {};
  ProjectToSurface steps = {};  ///< how points move onto a surface
  LopOptions lop = {};          ///< its `points` follow from `point_count`
  SurfaceOptions surface = {};  ///< its method follows from `method`
  CloudPreparation cloud = {};  ///< of the samples

  /// All but those of `surface` and `cloud`.
  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field: for values out of range, and for those that mean nothing to the method.
  void validate() const;
};

/// Points, and the samples onto whose surface they move.
struct ProjectInput {
  PointSet points;                        ///< to be moved
  std::string name = "the points";        ///< in messages
  std::optional<PointSet> onto = {};      ///< default: the points themselves, which denoises
  std::string onto_name = "the samples";  ///< in messages
};

/// Numbers of a run of project().
struct SANSMESH_API ProjectReport {
  std::string method;  ///< by name, as it was chosen
  /// How far points moved, unless new ones were spread; of lop only how many there are.
  SurfaceProjection moved;

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Points on a surface.
struct ProjectResult {
  PointSet points;       ///< moved or new, with normals where the surface has them
  ProjectReport report;  ///< how far they moved
  /// "surface": what there is to say of the samples and their surface, whose name the notes have.
  std::vector<Note> notes;
};

/// Moves points onto the surface of samples, spreads new ones over it (`points`), or consolidates them ("lop"). Throws
/// ArgumentError for bad options, DataError that begins with a name where there is no surface, or none near the points;
/// Cancelled.
SANSMESH_API ProjectResult project(ProjectInput input, const ProjectOptions& options, Progress& progress);

/// "t (double × 3 a point): 0 to 1, 2 to 3, …".
SANSMESH_API std::string array_words(const AttributeInfo& array);
/// "from (0, 0, 0) to (1, 2, 3)", to ten digits.
SANSMESH_API std::string box_words(const Box3& box);
/// All of it in lines for people.
SANSMESH_API std::vector<std::string> summary_of(const CloudInfo& info);

}  // namespace sansmesh::inline v1
