// Edits of fitted functions, and places where a function should not be trusted without a look.
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

/// Supports of a function (local approximations, each on a ball around its block) that an edit changes: all conditions
/// that are given must hold. Lengths and positions in the unit of the input.
struct SANSMESH_API EditSelection {
  /// A ball in space.
  struct Ball {
    Vec3 center;        ///< position in the input
    double radius = 0;  ///< length, > 0
  };
  /// One side of a plane.
  struct HalfSpace {
    Vec3 point;   ///< on the plane
    Vec3 normal;  ///< points to the side that is meant; any length but 0
  };
  std::optional<Ball> ball;             ///< its block meets the ball
  std::optional<Box3> box;              ///< its block meets the box
  std::optional<HalfSpace> half_space;  ///< its block's centre lies on the side that the normal points to
  /// Its samples cover less than this of it (about 1: all of it; METHODS §3.1), above 0, up to 2.
  std::optional<double> coverage_below;
  /// Its samples are too few for a plane, or cover less of it than this for its degree, 2, 3 or 4.
  std::optional<PaperCoverage> coverage_fails;
  std::optional<double> error_above;  ///< rms distance of its samples (length)
  std::optional<int> samples_below;   ///< it was fitted to fewer samples, >= 0
  std::optional<int> level_from;  ///< its block lies on this level of the tree or deeper, 0..20; 0 is the whole cube
  std::optional<int> level_to;    ///< its block lies on this level of the tree or above, 0..20
  std::optional<Vec3> sheet_at;   ///< on the connected sheet at this place (within two edges of a block there)
  /// On a sheet that hardly any samples stand for, or that is small beside the largest one; of sheets that bound no
  /// solid only on those that fewer than five samples stand for.
  bool spurious_sheets = false;
  bool all_but_largest = false;  ///< not on the largest sheet

  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// Polynomials of another degree, or of the highest below it that the samples determine; creases go.
struct SetDegree {
  int degree = 0;  ///< 0..4, or kAutomaticDegree: of each support the highest that its samples allow
};

/// Fitted again with other options. What is absent is as it was when the whole was fitted; with nothing set, edited
/// parts come back to what they were. Needs the samples.
struct Refit {
  std::optional<int> max_degree;  ///< largest degree of the local polynomials, 1..4
  std::optional<int> max_depth;   ///< deepest level of the tree, 2..14; no deeper than that of the fit
  std::optional<double> error;    ///< accepted rms error (length, > 0): blocks that fit better are not divided
  std::optional<double> support;  ///< support radius / circumscribed radius of the block, 1.1..2
  std::optional<bool> sharp;      ///< look for creases
};

/// Constants in place of polynomials.
struct SetConstant {
  double value = 1;        ///< in radii of each support, 0.001..1000 in size; positive: outside
  bool automatic = false;  ///< instead of the value: of each support, what all that are not selected make of its centre
};

/// The selected supports go.
struct RemoveSupports {};

/// Takes back this many of the last edits.
struct Undo {
  int steps = 1;  ///< 1 or more; edits that selected nothing count, edits already taken back do not
};

/// One edit of a function (docs/methods/function-editing.md).
struct Edit {
  EditSelection select;                                                      ///< which supports; none for Undo
  std::variant<SetDegree, Refit, SetConstant, RemoveSupports, Undo> action;  ///< what becomes of them
};

/// What an edit did.
struct SANSMESH_API EditReport {
  std::size_t chosen = 0;    ///< supports that were selected
  std::size_t supports = 0;  ///< that stand in their place
  Box3 changed;              ///< where the function may have changed (input); empty: nowhere
  /// The same more closely: boxes whose union holds it; they may overlap.
  std::vector<Box3> regions;
  std::string what;  ///< one line for people to read

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// How the mesh of an edited function was made.
struct SANSMESH_API MeshUpdate {
  bool local = false;       ///< false: the whole mesh was made anew
  std::size_t removed = 0;  ///< triangles of the old mesh that went
  std::size_t added = 0;    ///< triangles that are new
  std::size_t regions = 0;  ///< apart from each other, that were cut out again
  std::string why;          ///< why the whole was made anew, for people to read; empty if it was not

  static const ReportSchema& schema();  ///< a row for each thing that it tells
};

/// Why a place should not be trusted without a look.
enum class Suspicion : std::uint8_t {
  /// Samples cover little of the supports: holes and gaps of a scan; not where a sheet that bounds no solid ends.
  low_coverage,
  high_error,  ///< samples lie farther off than elsewhere: misaligned scans, detail that is not resolved
  /// A piece of surface that hardly any samples stand for, or that a mesh would leave out as too small; in functions
  /// with sheets that bound no solid only the samples count: few of them, however small a part is beside the largest.
  extra_sheet,
  steep  ///< the gradient is far from 1: sheets too close to each other, contradicting samples
};

/// Number of the kinds of Suspicion.
constexpr std::size_t kSuspicions = 4;

/// "low coverage", "high error", "extra sheet", "steep gradient".
SANSMESH_API const char* suspicion_name(Suspicion kind);

/// What Diagnosis::mesh is coloured in there (sRGB).
SANSMESH_API std::array<std::uint8_t, 3> suspicion_color(Suspicion kind);

/// From what on a place is suspicious.
struct SANSMESH_API DiagnoseOptions {
  double coverage_below = 0.3;  ///< of supports (METHODS §3.1), 0..1
  /// rms distance of a support's samples (length, input); default: six times the median of all, at least a quarter of
  /// the spacing.
  std::optional<double> error_above = {};
  double gradient_above = kSoundSlope;  ///< norm, > 1
  std::size_t places = 20;              ///< at most this many places of each kind

  static const OptionSchema& schema();  ///< a row a field
  /// Throws ArgumentError naming the field.
  void validate() const;
};

/// A place where the function should not be trusted without a look.
struct SuspiciousPlace {
  Suspicion kind = Suspicion::low_coverage;  ///< why
  Vec3 position;                             ///< middle (input)
  Vec3 normal;                               ///< of the surface there, outward, on average; 0 if it faces all ways
  double radius = 0;                         ///< of a ball around it (length)
  std::size_t supports = 0;                  ///< that are concerned
  double worst = 0;                          ///< coverage, error (length), area (length²) or gradient
  std::optional<Edit> edit;                  ///< that may mend it
};

/// Suspicious places of a function.
struct SANSMESH_API Diagnosis {
  std::vector<SuspiciousPlace> places;  ///< of each kind, the largest first
  std::array<std::size_t, kSuspicions>
      found{};                  ///< places of each kind, including those beyond DiagnoseOptions::places
  double error_above = 0;       ///< threshold used (length)
  double largest_gradient = 0;  ///< at and around the surface
  TriangleMesh mesh;            ///< with all components; coloured by what is suspicious
  /// The edits of the places that have one, in their order.
  std::vector<Edit> edits() const;
};

/// Edits of a script: JSON as described in docs/formats/edit-script.md. Throws ArgumentError that names the step and
/// the field.
SANSMESH_API std::vector<Edit> parse_edit_script(const std::string& json);

/// The script of some edits; parse_edit_script reads it back.
SANSMESH_API std::string edit_script(const std::vector<Edit>& edits);

}  // namespace sansmesh::inline v1
