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
  CloudPreparation cloud = {};  ///< done to the samples first
  FitOptions fit = {};          ///< of the function

  /// The rows of its parts.
  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const { fit.validate(); }
};

/// What was done to the samples.
struct SANSMESH_API FitFunctionReport {
  bool estimated_normals = false;       ///< there were none, or they were not wanted
  std::optional<OrientBy> oriented_by;  ///< from what the normals got their signs; nothing: from the input
  std::string alignment;  ///< what was done to scans, in words; empty where nothing was asked for (CloudUse::align)

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Function of samples.
struct FitFunctionResult {
  SurfaceFunction function;  ///< with the samples that it was fitted to
  FitFunctionReport report;  ///< what was done to them
  std::vector<Note> notes;   ///< "preparation": of the samples
};

/// Fits an adaptive partition of unity to points. Throws DataError where they cannot be reconstructed (fewer than 9,
/// all coincident, collinear or in a plane), ArgumentError for bad options, Cancelled.
SANSMESH_API FitFunctionResult fit_function(PointSet points, const FitFunctionOptions& options, Progress& progress);

/// Mesh of a function.
struct MeshFunctionResult {
  TriangleMesh mesh;        ///< in the coordinates of the input
  MeshReport report;        ///< how it was made
  std::vector<Note> notes;  ///< "mesh": what could not be as it was asked for, or samples that have no surface
};

/// The zero set of the function as a manifold mesh (closed unless it bounds no solid, was trimmed or cut by the box),
/// in the coordinates of the input. Throws DataError if nothing of it is left, ArgumentError for bad options,
/// Cancelled.
SANSMESH_API MeshFunctionResult mesh_of_function(const SurfaceFunction& function, const MeshOptions& options,
                                                 Progress& progress);

/// Numbers of a run of probe_function(). Distances from the surface are about those, without their sign.
struct SANSMESH_API ProbeFunctionReport {
  std::size_t points = 0;       ///< places
  std::size_t inside = 0;       ///< places with a negative value
  double mean = 0;              ///< distance (length)
  double median = 0;            ///< distance (length)
  double largest = 0;           ///< distance (length)
  double largest_gradient = 0;  ///< norm; near the surface about 1 where the function is sound

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Values of a function at one place.
struct SANSMESH_API ProbedPlace : LevelSetPoint {
  Vec3 at;  ///< in the coordinates of the input

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Of so many points results list each.
inline constexpr std::size_t kListedPoints = 20;

/// Values of a function at places.
struct SANSMESH_API ProbeFunctionResult {
  /// A place each: about the distance to the surface, negative inside, and the level set through the place; in the unit
  /// of the input.
  std::vector<ProbedPlace> values;
  ProbeFunctionReport report;  ///< over all of them

  /// Sets the attributes value, gradient_x, gradient_y, gradient_z, k1 and k2 (float, a row a place). Throws
  /// ArgumentError where the table has another number of rows.
  void add_to(AttributeTable& attributes) const;
};

/// Evaluates a function at places in the input's coordinates. Throws Cancelled.
SANSMESH_API ProbeFunctionResult probe_function(const SurfaceFunction& function, std::span<const Vec3> places,
                                                Progress& progress);

/// The points inside and, of twenty at most, each with its values, else statistics; in lines for people.
SANSMESH_API std::vector<std::string> summary_of(const ProbeFunctionResult& probed);

/// Positions of points in coordinates of the input: origin + position.
SANSMESH_API std::vector<Vec3> places_of(const PointSet& points);

/// A function to be edited, and its mesh, if there is one.
struct EditInput {
  SurfaceFunction function;           ///< stays as it is: edits make another one
  std::string name = "the function";  ///< in messages
  /// The function's mesh before the edits, by mesh_of_function with default options: only what they change is made
  /// anew.
  std::optional<TriangleMesh> mesh = {};
  std::string mesh_name = "the mesh";  ///< in messages
};

/// An edited function.
struct SANSMESH_API EditedFunction {
  SurfaceFunction function;       ///< after all edits
  std::vector<EditReport> steps;  ///< of each edit
  TriangleMesh mesh = {};         ///< of the function; empty unless asked for
  MeshUpdate update = {};         ///< what of it is new; of one that was made without another nothing is told

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Edits a function, one edit after the other; with `make_mesh` also its mesh as the edits leave it. Throws
/// ArgumentError that begins with the step, "step 2: ", for edits with values out of range; DataError that begins with
/// a name where an edit cannot be done, nothing is left to be meshed, or the mesh is not one of the function;
/// Cancelled.
SANSMESH_API EditedFunction edit(EditInput input, const std::vector<Edit>& edits, bool make_mesh, Progress& progress);

/// A suspicious place with its numbers in the list.
struct SANSMESH_API ListedPlace {
  SuspiciousPlace place;            ///< where, and why
  std::size_t number = 0;           ///< from 1 on, kinds in their order
  std::optional<std::size_t> step;  ///< of the edits, from 1 on

  /// The place's `worst` in words: "coverage down to 0.12".
  std::string worst_words() const;

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Suspicious places of a function, with edits to try.
struct SANSMESH_API DiagnoseResult {
  std::size_t fits = 0;             ///< local approximations of the function
  Diagnosis diagnosis;              ///< the places and the coloured mesh
  std::vector<ListedPlace> places;  ///< the same places, numbered
  std::vector<Edit> edits;          ///< to try, one for each place that has a step

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Looks for places where a function should not be trusted without a look (METHODS §3.1,
/// docs/methods/function-editing.md). Throws ArgumentError for bad options, DataError where the function has no
/// surface; Cancelled.
SANSMESH_API DiagnoseResult diagnose(const SurfaceFunction& function, const DiagnoseOptions& options,
                                     Progress& progress);

/// The places, kind by kind, in lines for people; `steps`: with the number of the edit that may mend each.
SANSMESH_API std::vector<std::string> summary_of(const DiagnoseResult& made, bool steps);

/// Facts of a function. Lengths and places in the unit of the input.
struct SANSMESH_API FunctionInfo {
  std::size_t fits = 0;           ///< local approximations
  FitsOfDegree fits_of_degree{};  ///< how many of them have degree 0, 1, …, kMaxDegree
  std::size_t creased = 0;        ///< fits with a crease or corner
  int depth = 0;                  ///< deepest level of the tree
  /// Share of the surface that bounds no solid and ends with its samples.
  double open_share = 0;
  double behind = 1;                 ///< mean winding number just behind the samples: 1 if the surface is closed
  std::size_t samples = 0;           ///< that were kept
  bool colors = false;               ///< of these
  Box3 cube;                         ///< in which the function is defined: the whole tree of blocks
  double spacing = 0;                ///< of the samples: edge of the square that one stands for (length)
  double deviation = 0;              ///< of the samples from the surface, root mean square (length)
  double accuracy = 0;               ///< estimated error of the surface, root mean square (length)
  std::vector<std::string> history;  ///< edits that made it, one line each
  std::optional<PaperReport> paper;  ///< of FitMethod::paper: how its blocks came to be; files do not keep it

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// What is known of a function, without evaluating it.
SANSMESH_API FunctionInfo info(const SurfaceFunction& function);

/// An edit and its place, in words.
SANSMESH_API std::string words_of(const EditReport& step);
/// What of a mesh of so many triangles is new: ", of which 162 are new; 98.8 % kept", or why all of it is.
SANSMESH_API std::string words_of(const MeshUpdate& update, std::size_t triangles);
/// All of it in lines for people.
SANSMESH_API std::vector<std::string> summary_of(const FunctionInfo& info);

}  // namespace sansmesh::inline v1
