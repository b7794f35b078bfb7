// Editing of fitted functions in the coordinates of their input: choose supports, replace what they hold, take it back.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/function/surface_function.h"
#include "sansmesh/partition/edit_result.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

/// Which supports: all conditions that are given must hold. Lengths and positions in the unit of the input.
struct EditSelection {
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

struct EditReport {
  std::size_t chosen = 0;    ///< supports that were selected
  std::size_t supports = 0;  ///< that stand in their place
  Box3 changed;              ///< where the function may have changed (input); empty: nowhere
  /// The same more closely: boxes whose union holds it; they may overlap.
  std::vector<Box3> regions;
  std::string what;  ///< one line for people to read

  static const ReportSchema& schema();
};

/// A function, and what it was before each edit.
class FunctionEditor {
 public:
  explicit FunctionEditor(SurfaceFunction function);

  const SurfaceFunction& function() const { return function_; }
  /// Throws ArgumentError for values out of range, DataError where it cannot be done (no samples, nothing would be
  /// left); the function is then as it was. Nothing selected is no error.
  EditReport apply(const Edit& edit, Progress& progress);
  /// Where anything differs from the function that the editor was given (input coordinates): in the union of these
  /// boxes, which may overlap; none: nowhere.
  const std::vector<Box3>& changed() const { return changed_; }
  std::size_t edits() const { return before_.size(); }

 private:
  struct Before {
    PartitionOfUnity field;
    std::vector<Box3> changed;
    std::size_t history;  ///< lines
  };
  EditReport undo(int steps);

  SurfaceFunction function_;
  std::vector<Before> before_;
  std::vector<Box3> changed_;
};

}  // namespace sansmesh::inline v1
