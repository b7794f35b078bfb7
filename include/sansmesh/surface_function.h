// Functions fitted to samples: what `.smf` files keep, and what meshing, editing and evaluation start from.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/scalar_field.h"

namespace sansmesh::inline v1 {

struct FittedFunction;

/// A partition of unity (METHODS §3.1) with its place in the input and the samples that it was fitted to. Cheap to
/// copy: what it holds is shared and never changes. Made by fit_function and read_function, edited by edit.
class SANSMESH_API SurfaceFunction {
 public:
  explicit SurfaceFunction(FittedFunction fitted);

  /// Values and gradients anywhere, in the coordinates of the input: about the distance to the surface, negative
  /// inside. Owns what it needs.
  std::shared_ptr<const ScalarField> field() const;
  /// Around its samples, in the coordinates of the input; the field's own where samples were not kept.
  Box3 bounds() const;
  /// Samples that were kept; 0: it can be meshed and evaluated, but no part of it fitted again.
  std::size_t samples() const;
  /// Edits that made it, one line each.
  const std::vector<std::string>& history() const;

  /// Parts that only the library's own sources know.
  const FittedFunction& fitted() const { return *fitted_; }
  const std::shared_ptr<const FittedFunction>& shared() const { return fitted_; }

 private:
  std::shared_ptr<const FittedFunction> fitted_;
};

/// Whether a file is a function file, by its name (.smf, .smf.gz).
SANSMESH_API bool is_function_file(const std::string& file);

/// Reads a function file (docs/formats/smf.md). Functions and supports stay in the file, mapped into memory; samples
/// are copied. Throws FileError where it is missing, not a function file, truncated, damaged or from a newer version.
SANSMESH_API SurfaceFunction read_function(const std::string& file);

/// Writes one, atomically. Throws FileError. `with_samples` = false leaves the samples out: smaller, but such a
/// function cannot be refitted.
SANSMESH_API void write_function(const std::string& file, const SurfaceFunction& function, bool with_samples = true);

}  // namespace sansmesh::inline v1
