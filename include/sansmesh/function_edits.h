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

/// Which supports: all conditions that are given must hold. Lengths and positions in the unit of the input.
struct SANSMESH_API EditSelection {
  struct Ball {
    Vec3 center;
    double radius;
  };
  struct HalfSpace {
    Vec3 point, normal;
  };
  std::optional<Ball> ball;             ///< its block meets the ball
  std::optional<Box3> box;              ///< its block meets the box
  std::optional<HalfSpace> half_space;  ///< its block's centre lies on the side that the normal points to
  std::optional<double> coverage_below;
  /// Its samples are too few for a plane, or cover less of it than this for its degree, 2, 3 or 4.
  std::optional<PaperCoverage> coverage_fails;
  std::optional<double> error_above;  ///< rms distance of its samples (length)
  std::optional<int> samples_below;
  std::optional<int> level_from, level_to;
  std::optional<Vec3> sheet_at;  ///< on the connected sheet at this place (within two edges of a block there)
  /// On a sheet that hardly any samples stand for, or that is small beside the largest one; of sheets that bound no
  /// solid (Support::open) only on those that fewer than five samples stand for.
  bool spurious_sheets = false;
  bool all_but_largest = false;  ///< not on the largest sheet

  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct SetDegree {
  int degree;  ///< 0..4, or kAutomaticDegree: of each support the highest that its samples allow
};

struct Refit {
  std::optional<int> max_degree, max_depth;
  std::optional<double> error;  ///< accepted rms error (length)
  std::optional<double> support;
  std::optional<bool> sharp;
};

struct SetConstant {
  double value = 1;        ///< in radii of each support; positive: outside
  bool automatic = false;  ///< instead of the value: of each support, what all that are not selected make of its centre
};

struct RemoveSupports {};

/// Takes back this many of the last edits.
struct Undo {
  int steps = 1;
};

struct Edit {
  EditSelection select;
  std::variant<SetDegree, Refit, SetConstant, RemoveSupports, Undo> action;
};

struct SANSMESH_API EditReport {
  std::size_t chosen = 0;    ///< supports that were selected
  std::size_t supports = 0;  ///< that stand in their place
  Box3 changed;              ///< where the function may have changed (input); empty: nowhere
  /// The same more closely: boxes whose union holds it; they may overlap.
  std::vector<Box3> regions;
  std::string what;  ///< one line for people to read

  static const ReportSchema& schema();
};

struct SANSMESH_API MeshUpdate {
  bool local = false;                  ///< false: the whole mesh was made anew
  std::size_t removed = 0, added = 0;  ///< triangles
  std::size_t regions = 0;             ///< apart from each other, that were cut out again
  std::string why;                     ///< why the whole was made anew, for people to read; empty if it was not

  static const ReportSchema& schema();
};

enum class Suspicion : std::uint8_t {
  /// Samples cover little of the supports: holes and gaps of a scan; not where a sheet that bounds no solid ends.
  low_coverage,
  high_error,  ///< samples lie farther off than elsewhere: misaligned scans, detail that is not resolved
  /// A piece of surface that hardly any samples stand for, or that a mesh would leave out as too small; in functions
  /// with sheets that bound no solid only the samples count: few of them, however small a part is beside the largest.
  extra_sheet,
  steep  ///< the gradient is far from 1: sheets too close to each other, contradicting samples
};

constexpr std::size_t kSuspicions = 4;

SANSMESH_API const char* suspicion_name(Suspicion kind);

/// What Diagnosis::mesh is coloured in there (sRGB).
SANSMESH_API std::array<std::uint8_t, 3> suspicion_color(Suspicion kind);

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

struct SuspiciousPlace {
  Suspicion kind;
  Vec3 position;             ///< middle (input)
  Vec3 normal;               ///< of the surface there, outward, on average; 0 if it faces all ways
  double radius = 0;         ///< of a ball around it (length)
  std::size_t supports = 0;  ///< that are concerned
  double worst = 0;          ///< coverage, error (length), area (length²) or gradient
  std::optional<Edit> edit;  ///< that may mend it
};

struct SANSMESH_API Diagnosis {
  std::vector<SuspiciousPlace> places;  ///< of each kind, the largest first
  std::array<std::size_t, kSuspicions>
      found{};                  ///< places of each kind, including those beyond DiagnoseOptions::places
  double error_above = 0;       ///< threshold used (length)
  double largest_gradient = 0;  ///< at and around the surface
  TriangleMesh mesh;            ///< with all components; coloured by what is suspicious
  std::vector<Edit> edits() const;
};

/// Edits of a script: JSON as described in docs/formats/edit-script.md. Throws ArgumentError that names the step and
/// the field.
SANSMESH_API std::vector<Edit> parse_edit_script(const std::string& json);

/// The script of some edits; parse_edit_script reads it back.
SANSMESH_API std::string edit_script(const std::vector<Edit>& edits);

}  // namespace sansmesh::inline v1
