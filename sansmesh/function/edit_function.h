// Editing of fitted functions in the coordinates of their input: choose supports, replace what they hold, take it back.
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/function_edits.h"
#include "sansmesh/partition/edit_result.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// A function, and what it was before each edit.
class FunctionEditor {
 public:
  explicit FunctionEditor(FittedFunction function);

  const FittedFunction& function() const { return function_; }
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

  FittedFunction function_;
  std::vector<Before> before_;
  std::vector<Box3> changed_;
};

}  // namespace sansmesh::inline v1
