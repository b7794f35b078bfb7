// Editing of fitted functions in input coordinates: selection, replacement and undo.
#pragma once

#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/function/fitted_function.h"
#include "sansmesh/function_edits.h"
#include "sansmesh/partition/edit/edit_result.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// A function with its states before each edit.
class FunctionEditor {
 public:
  explicit FunctionEditor(FittedFunction function);

  const FittedFunction& function() const { return function_; }
  /// Throws ArgumentError for values out of range, DataError if the edit is impossible (no samples, empty result); the
  /// function is then unchanged. An empty selection is no error.
  EditReport apply(const Edit& edit, Progress& progress);
  /// Differences from the function that the editor was given (input coordinates): within the union of these boxes,
  /// which may overlap; empty: none.
  const std::vector<Box3>& changed() const { return changed_; }
  std::size_t edits() const { return before_.size(); }

 private:
  struct Before {
    PartitionOfUnity field;
    std::vector<Box3> changed;
    std::size_t history;  ///< number of lines
  };
  EditReport undo(int steps);

  FittedFunction function_;
  std::vector<Before> before_;
  std::vector<Box3> changed_;
};

}  // namespace sansmesh::inline v1
