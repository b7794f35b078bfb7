// Edits of fitted functions, and diagnosis of their doubtful regions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/fit_options.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Selects the supports of a function (local approximations, each on a ball around its block) that an edit changes. All
/// given conditions must hold. Lengths and positions in the unit of the input.
struct SANSMESH_API EditSelection {
  /// A ball in space.
  struct Ball {
    Vec3 center;        ///< position in the input
    double radius = 0;  ///< length, > 0
  };
  /// One side of a plane.
  struct HalfSpace {
    Vec3 point;   ///< on the plane
    Vec3 normal;  ///< points to the selected side; any length but 0
  };
  std::optional<Ball> ball;             ///< the block meets the ball
  std::optional<Box3> box;              ///< the block meets the box
  std::optional<HalfSpace> half_space;  ///< the block's centre is on the side of the normal
  /// The samples cover less than this share of the support, above 0, up to 2 (about 1: all of it; tejada2008, 4.4.3).
  std::optional<double> coverage_below;
  /// The samples are too few for a plane, or their coverage is below this for the support's degree, 2, 3 or 4.
  std::optional<PaperCoverage> coverage_fails;
  std::optional<double> error_above;  ///< rms distance of the samples exceeds this (length)
  std::optional<int> samples_below;   ///< the support was fitted to fewer samples, >= 0
  std::optional<int> level_from;      ///< the block is on this level of the tree or deeper, 0..20; 0 is the whole cube
  std::optional<int> level_to;        ///< the block is on this level of the tree or above, 0..20
  std::optional<Vec3> sheet_at;       ///< on the connected sheet at this point (within two edges of a block there)
  /// On a sheet that hardly any samples represent, or that is small beside the largest one. For open sheets only the
  /// first condition counts: fewer than five samples represent the sheet.
  bool spurious_sheets = false;
  bool all_but_largest = false;  ///< not on the largest sheet

  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Replaces the polynomials by those of another degree, or of the highest degree below it that the samples determine.
/// Removes creases.
struct SetDegree {
  int degree = 0;  ///< 0..4, or kAutomaticDegree: the highest degree that each support's samples allow
};

/// Fits again with other options. Absent options keep the values of the original fit; with no option set, edited parts
/// are restored. Needs the samples.
struct Refit {
  std::optional<int> max_degree;  ///< largest degree of the local polynomials, 1..4
  std::optional<int> max_depth;   ///< deepest level of the tree, 2..14; at most that of the fit
  std::optional<double> error;    ///< accepted rms error (length, > 0): blocks with a smaller error are not divided
  std::optional<double> support;  ///< support radius / circumscribed radius of the block, 1.1..2
  std::optional<bool> sharp;      ///< look for creases
};

/// Replaces the polynomials by constants.
struct SetConstant {
  double value = 1;        ///< in radii of each support, magnitude 0.001..1000; positive: outside
  bool automatic = false;  ///< use the value of all unselected supports at each support's centre instead
};

/// Removes the selected supports.
struct RemoveSupports {};

/// Reverts the last edits.
struct Undo {
  int steps = 1;  ///< number of edits, >= 1; edits that selected nothing count, reverted edits do not
};

/// One edit of a function (docs/methods/function-editing.md).
struct Edit {
  EditSelection select;                                                      ///< selected supports; unused for Undo
  std::variant<SetDegree, Refit, SetConstant, RemoveSupports, Undo> action;  ///< change of the selected supports
};

/// Result of an edit.
struct SANSMESH_API EditReport {
  std::size_t chosen = 0;    ///< selected supports
  std::size_t supports = 0;  ///< supports that replace them
  Box3 changed;              ///< region where the function may have changed (input); empty: nowhere
  /// A finer description: boxes whose union contains that region; they may overlap.
  std::vector<Box3> regions;
  std::string what;  ///< the edit as one line of text

  static const ReportSchema& schema();  ///< one row a figure
};

/// Update of a mesh after an edit of its function.
struct SANSMESH_API MeshUpdate {
  bool local = false;       ///< false: the whole mesh was extracted again
  std::size_t removed = 0;  ///< removed triangles of the old mesh
  std::size_t added = 0;    ///< new triangles
  std::size_t regions = 0;  ///< separate regions that were extracted again
  std::string why;          ///< reason for extracting the whole mesh, as text; empty if local

  static const ReportSchema& schema();  ///< one row a figure
};

/// Kinds of doubtful regions of a function.
enum class Suspicion : std::uint8_t {
  /// Samples cover only a small share of the supports: holes and gaps of a scan. Not reported at the rim of open
  /// sheets.
  low_coverage,
  high_error,  ///< samples are farther from the surface than elsewhere: misaligned scans, unresolved detail
  /// A part of the surface that hardly any samples represent, or that meshing would drop as too small. For open sheets
  /// only the number of samples counts, not the size beside the largest part.
  extra_sheet,
  steep  ///< the gradient's length is far from 1: sheets too close to each other, contradicting samples
};

/// Number of kinds of Suspicion.
constexpr std::size_t kSuspicions = 4;

/// "low coverage", "high error", "extra sheet", "steep gradient".
SANSMESH_API const char* suspicion_name(Suspicion kind);

/// Colour of the kind in Diagnosis::mesh (sRGB).
SANSMESH_API std::array<std::uint8_t, 3> suspicion_color(Suspicion kind);

/// Thresholds of the diagnosis.
struct SANSMESH_API DiagnoseOptions {
  double coverage_below = 0.3;  ///< least coverage of supports (tejada2008, 4.4.3), 0..1
  /// Largest rms distance of a support's samples (length, input); default: six times the median of all supports, at
  /// least a quarter of the spacing.
  std::optional<double> error_above = {};
  double gradient_above = kPlausibleGradient;  ///< largest length of the gradient, > 1
  std::size_t most_regions = 20;  ///< largest number of reported regions of each kind; schema name: "places"

  static const OptionSchema& schema();  ///< one row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// A doubtful region of the function.
struct SuspiciousRegion {
  Suspicion kind = Suspicion::low_coverage;  ///< reason
  Vec3 position;                             ///< centre (input)
  Vec3 normal;                               ///< mean outward normal of the surface there; 0 if directions cancel
  double radius = 0;                         ///< radius of the enclosing ball (length)
  std::size_t supports = 0;                  ///< number of affected supports
  double worst = 0;                          ///< coverage, error (length), area (length²) or gradient
  std::optional<Edit> edit;                  ///< edit that may repair it
};

/// Doubtful regions of a function.
struct SANSMESH_API Diagnosis {
  std::vector<SuspiciousRegion> regions;  ///< grouped by kind, the largest first
  /// Number of regions of each kind, including those beyond DiagnoseOptions::most_regions.
  std::array<std::size_t, kSuspicions> found{};
  double error_above = 0;       ///< threshold used (length)
  double largest_gradient = 0;  ///< at and around the surface
  TriangleMesh mesh;            ///< mesh with all components; coloured by suspicion_color
  /// The edits of the regions that have one, in their order.
  std::vector<Edit> edits() const;
};

/// Edits of a script: JSON as described in docs/formats/edit-script.md. Throws ArgumentError naming the step and the
/// field.
SANSMESH_API std::vector<Edit> parse_edit_script(const std::string& json);

/// Script of a list of edits; parse_edit_script reads it back.
SANSMESH_API std::string edit_script(const std::vector<Edit>& edits);

}  // namespace sansmesh::inline v1
