// Jobs on functions: fitted to points, meshed, probed, edited, diagnosed.
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
  CloudUse cloud = {};
  FitOptions fit = {};

  /// Throws ArgumentError naming the field.
  void validate() const { fit.validate(); }
};

struct SANSMESH_API FitFunctionReport {
  bool estimated_normals = false;       ///< there were none, or they were not wanted
  std::optional<OrientBy> oriented_by;  ///< from what the normals got their signs; nothing: from the input
  std::string alignment;  ///< what was done to scans, in words; empty where nothing was asked for (CloudUse::align)

  static const ReportSchema& schema();
};

struct FitFunctionResult {
  SurfaceFunction function;
  FitFunctionReport report;
  std::vector<Note> notes;  ///< "preparation": of the samples
};

/// Throws DataError where the points cannot be reconstructed (fewer than 9, all coincident, collinear or in a plane),
/// ArgumentError for bad options, Cancelled.
SANSMESH_API FitFunctionResult fit_function(PointSet points, const FitFunctionOptions& options, Progress& progress);

struct MeshFunctionResult {
  TriangleMesh mesh;
  MeshReport report;
  std::vector<Note> notes;  ///< "mesh": what could not be as it was asked for, or samples that have no surface
};

/// The zero set of the function as a manifold mesh (closed unless it bounds no solid, was trimmed or cut by the box),
/// in the coordinates of the input. Throws DataError if nothing of it is left, ArgumentError for bad options,
/// Cancelled.
SANSMESH_API MeshFunctionResult mesh_of_function(const SurfaceFunction& function, const MeshOptions& options,
                                                 Progress& progress);

struct SANSMESH_API ProbeFunctionReport {
  std::size_t points = 0;
  std::size_t inside = 0;
  // Of the distances from the surface, about (length).
  double mean = 0, median = 0, largest = 0;
  double largest_gradient = 0;

  static const ReportSchema& schema();
};

struct SANSMESH_API ProbedPlace : LevelSetPoint {
  Vec3 at;

  static const ReportSchema& schema();
};

struct SANSMESH_API ProbeFunctionResult {
  /// A place each: about the distance to the surface, negative inside, and the level set through the place; in the unit
  /// of the input.
  std::vector<ProbedPlace> values;
  ProbeFunctionReport report;

  /// As the attributes value, gradient_x, gradient_y, gradient_z, k1 and k2.
  void add_to(AttributeTable& attributes) const;
};

/// At places in the input's coordinates. Throws Cancelled.
SANSMESH_API ProbeFunctionResult probe_function(const SurfaceFunction& function, std::span<const Vec3> places,
                                                Progress& progress);

/// Positions of points in coordinates of the input.
SANSMESH_API std::vector<Vec3> places_of(const PointSet& points);

struct EditInput {
  SurfaceFunction function;
  std::string name = "the function";  ///< in messages
  /// The function's mesh before the edits, by mesh_function without options: only what they change is made anew.
  std::optional<TriangleMesh> mesh = {};
  std::string mesh_name = "the mesh";
};

struct SANSMESH_API EditedFunction {
  SurfaceFunction function;
  std::vector<EditReport> steps;
  // If a mesh is asked for.
  TriangleMesh mesh = {};
  MeshUpdate update = {};  ///< what of it is new; of one that was made without another nothing is told

  static const ReportSchema& schema();
};

/// `make_mesh`: of the function as the edits leave it. Throws ArgumentError that begins with the step, "step 2: ", for
/// edits with values out of range; DataError that begins with a name where an edit cannot be done, nothing is left to
/// be meshed, or the mesh is not one of the function; Cancelled.
SANSMESH_API EditedFunction edit(EditInput input, const std::vector<Edit>& edits, bool make_mesh, Progress& progress);

/// A place as the list has it.
struct SANSMESH_API ListedPlace {
  SuspiciousPlace place;
  std::size_t number = 0;           ///< from 1 on, kinds in their order
  std::optional<std::size_t> step;  ///< of the edits, from 1 on

  /// "coverage down to 0.12"
  std::string worst_words() const;

  static const ReportSchema& schema();
};

struct SANSMESH_API DiagnoseResult {
  std::size_t fits = 0;  ///< of the function
  Diagnosis diagnosis;
  std::vector<ListedPlace> places;
  std::vector<Edit> edits;  ///< to try, one for each place that has a step

  static const ReportSchema& schema();
};

/// By diagnose_function. Throws ArgumentError for bad options, DataError where the function has no surface; Cancelled.
SANSMESH_API DiagnoseResult diagnose(const SurfaceFunction& function, const DiagnoseOptions& options,
                                     Progress& progress);

struct SANSMESH_API FunctionInfo {
  std::size_t fits = 0;
  FitsOfDegree fits_of_degree{};
  std::size_t creased = 0;  ///< fits
  int depth = 0;            ///< deepest level of the tree
  /// Share of the surface that bounds no solid and ends with its samples.
  double open_share = 0;
  double behind = 1;        ///< mean winding number just behind the samples: 1 if the surface is closed
  std::size_t samples = 0;  ///< that were kept
  bool colors = false;      ///< of these
  Box3 cube;
  double spacing = 0;
  double deviation = 0;  ///< of the samples from the surface, root mean square
  double accuracy = 0;   ///< expected error of the surface
  std::vector<std::string> history;
  std::optional<PaperReport> paper;  ///< of FitMethod::paper: how its blocks came to be; files do not keep it

  static const ReportSchema& schema();
};

SANSMESH_API FunctionInfo info(const SurfaceFunction& function);

/// An edit and its place, in words.
SANSMESH_API std::string words_of(const EditReport& step);
/// What of a mesh of so many triangles is new: ", of which 162 are new; 98.8 % kept", or why all of it is.
SANSMESH_API std::string words_of(const MeshUpdate& update, std::size_t triangles);
/// All of it in lines for people.
SANSMESH_API std::vector<std::string> summary_of(const FunctionInfo& info);

}  // namespace sansmesh::inline v1
