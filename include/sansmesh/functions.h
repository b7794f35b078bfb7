// Jobs on functions: fit, mesh, probe, edit and diagnose.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/attribute_table.h"
#include "sansmesh/box.h"
#include "sansmesh/cloud_options.h"
#include "sansmesh/fit_options.h"
#include "sansmesh/function_edits.h"
#include "sansmesh/mesh_measures.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/note.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/surface_function.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Options of preparation and fit.
struct FitFunctionOptions {
  CloudPreparation cloud = {};  ///< preparation of the samples
  FitOptions fit = {};          ///< fit of the function

  /// Option rows of its parts.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const { fit.validate(); }
};

/// Preparation of the samples.
struct SANSMESH_API FitFunctionReport {
  bool estimated_normals = false;       ///< the input had no normals, or they were not used
  std::optional<OrientBy> oriented_by;  ///< origin of the signs of normals; empty: the input
  std::string alignment;  ///< registration of scans as text; empty if not requested (CloudPreparation::align)

  static const ReportSchema& schema();  ///< report rows
};

/// Function fitted to samples.
struct FitFunctionResult {
  SurfaceFunction function;  ///< function with its samples
  FitFunctionReport report;  ///< preparation of the samples
  std::vector<Note> notes;   ///< on the preparation of the samples
};

/// Fits an adaptive partition of unity to points. Throws DataError if they cannot be reconstructed (fewer than 9, all
/// coincident, collinear or coplanar), ArgumentError for bad options, Cancelled.
SANSMESH_API FitFunctionResult fit_function(PointSet points, const FitFunctionOptions& options, Progress& progress);

/// Mesh of a function.
struct MeshFunctionResult {
  TriangleMesh mesh;        ///< mesh in the coordinates of the input
  MeshReport report;        ///< how it was made
  std::vector<Note> notes;  ///< options that could not be satisfied, samples without a surface
};

/// The zero set of the function as a manifold mesh in the coordinates of the input. It is closed unless it bounds no
/// solid, was trimmed, or was cut by the box. Throws DataError if nothing is left, ArgumentError for bad options,
/// Cancelled.
SANSMESH_API MeshFunctionResult mesh_of_function(const SurfaceFunction& function, const MeshOptions& options,
                                                 Progress& progress);

/// Report of probe_function(). Distances from the surface are absolute values of the approximate signed distances.
struct SANSMESH_API ProbeFunctionReport {
  std::size_t points = 0;       ///< query points
  std::size_t inside = 0;       ///< query points with negative values
  double mean = 0;              ///< distance (length)
  double median = 0;            ///< distance (length)
  double largest = 0;           ///< distance (length)
  double largest_gradient = 0;  ///< norm of the gradient; about 1 near the surface of a sound function

  static const ReportSchema& schema();  ///< report rows
};

/// Values of a function at a query point.
struct SANSMESH_API ProbedPoint : LevelSetPoint {
  Vec3 at;  ///< query point in the coordinates of the input

  static const ReportSchema& schema();  ///< report rows
};

/// Results list single points up to this number.
inline constexpr std::size_t kListedPoints = 20;

/// Values of a function at query points.
struct SANSMESH_API ProbeFunctionResult {
  /// Per query point: approximate signed distance, negative inside, and the geometry of the level set through the
  /// point; in the unit of the input.
  std::vector<ProbedPoint> values;
  ProbeFunctionReport report;  ///< statistics of all points

  /// Sets the attributes value, gradient_x, gradient_y, gradient_z, k1 and k2 (float, one row per point). Throws
  /// ArgumentError if the table has another number of rows.
  void add_to(AttributeTable& attributes) const;
};

/// Evaluates a function at points in the input's coordinates. Throws Cancelled.
SANSMESH_API ProbeFunctionResult probe_function(const SurfaceFunction& function, std::span<const Vec3> points,
                                                Progress& progress);

/// Points inside, and the values of up to twenty points, else statistics; as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const ProbeFunctionResult& probed);

/// Positions of points in the coordinates of the input: origin + position.
SANSMESH_API std::vector<Vec3> positions_of(const PointSet& points);

/// A function to edit, and optionally its mesh.
struct EditInput {
  SurfaceFunction function;           ///< unchanged; edits make a new function
  std::string name = "the function";  ///< name in messages
  /// Mesh of the function before the edits, from mesh_of_function with default options. Only the parts that the edits
  /// change are meshed again.
  std::optional<TriangleMesh> mesh = {};
  std::string mesh_name = "the mesh";  ///< name in messages
};

/// An edited function.
struct SANSMESH_API EditedFunction {
  SurfaceFunction function;       ///< function after all edits
  std::vector<EditReport> steps;  ///< report of each edit
  TriangleMesh mesh = {};         ///< mesh of the function; empty unless requested
  MeshUpdate update = {};         ///< changes of the mesh; empty if there was no previous mesh

  static const ReportSchema& schema();  ///< report rows
};

/// Applies edits to a function in order; `make_mesh` also returns its mesh. Throws ArgumentError that begins with the
/// step, "step 2: ", for values out of range; DataError that begins with a name if an edit fails, nothing is left to
/// mesh, or the mesh is not one of the function; Cancelled.
SANSMESH_API EditedFunction edit(EditInput input, const std::vector<Edit>& edits, bool make_mesh, Progress& progress);

/// Doubtful region of a function, numbered.
struct SANSMESH_API ListedRegion {
  SuspiciousRegion region;          ///< location and reason
  std::size_t number = 0;           ///< number from 1, grouped by kind
  std::optional<std::size_t> step;  ///< number of the proposed edit, from 1

  /// The region's worst measure as text: "coverage down to 0.12".
  std::string worst_words() const;

  static const ReportSchema& schema();  ///< report rows
};

/// Doubtful regions of a function, with proposed edits.
struct SANSMESH_API DiagnoseResult {
  std::size_t fits = 0;               ///< local approximations of the function
  Diagnosis diagnosis;                ///< regions and the coloured mesh
  std::vector<ListedRegion> regions;  ///< the same regions, numbered
  std::vector<Edit> edits;            ///< proposed edits, one for each region that has a step

  static const ReportSchema& schema();  ///< report rows
};

/// Finds doubtful regions of a function (docs/methods/function-editing.md). Throws ArgumentError for bad options,
/// DataError if the function has no surface; Cancelled.
SANSMESH_API DiagnoseResult diagnose(const SurfaceFunction& function, const DiagnoseOptions& options,
                                     Progress& progress);

/// The regions by kind, as lines of text. `steps`: with the number of the edit that may repair each.
SANSMESH_API std::vector<std::string> summary_of(const DiagnoseResult& made, bool steps);

/// Facts about a function. Lengths and positions in the unit of the input.
struct SANSMESH_API FunctionInfo {
  std::size_t fits = 0;           ///< local approximations
  FitsOfDegree fits_of_degree{};  ///< how many of them have degree 0, 1, …, kMaxDegree
  std::size_t creased = 0;        ///< fits with a crease or corner
  int depth = 0;                  ///< deepest level of the tree
  /// Share of the surface that bounds no solid and ends with its samples.
  double open_share = 0;
  double mean_winding_number = 1;    ///< mean winding number just behind the samples: 1 for a closed surface
  std::size_t samples = 0;           ///< samples that were kept
  bool colors = false;               ///< the samples have colours
  Box3 cube;                         ///< domain of the function: the cube of the octree
  double spacing = 0;                ///< sample spacing: edge of the square that one sample represents (length)
  double deviation = 0;              ///< distance of the samples from the surface, root mean square (length)
  double accuracy = 0;               ///< estimated error of the surface, root mean square (length)
  std::vector<std::string> history;  ///< edits applied so far, one line each
  std::optional<PaperReport> paper;  ///< FitMethod::paper: construction of its blocks; not stored in files

  static const ReportSchema& schema();  ///< report rows
};

/// Facts that need no evaluation.
SANSMESH_API FunctionInfo info(const SurfaceFunction& function);

/// An edit and its region as text.
SANSMESH_API std::string words_of(const EditReport& step);
/// New part of a mesh with that many triangles: ", of which 162 are new; 98.8 % kept", or why all of it is new.
SANSMESH_API std::string words_of(const MeshUpdate& update, std::size_t triangles);
/// All facts as lines of text.
SANSMESH_API std::vector<std::string> summary_of(const FunctionInfo& info);

}  // namespace sansmesh::inline v1
