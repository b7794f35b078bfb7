// Functions fitted to samples, the content of `.smf` files. Meshing, editing and evaluation start from them.
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

/// A partition of unity (tejada2008, 4.4; polizelli) with its local frame in the input and the samples that it was
/// fitted to. Cheap to copy: the content is shared and immutable. Made by fit_function and read_function, edited by
/// edit.
class SANSMESH_API SurfaceFunction {
 public:
  /// For the library's own sources. Programs call fit_function, read_function and edit.
  explicit SurfaceFunction(FittedFunction fitted);

  /// Values and gradients at any point, in the coordinates of the input: approximately the distance to the surface,
  /// negative inside. Owns its data and may outlive this object.
  std::shared_ptr<const ScalarField> field() const;
  /// Bounding box of the samples, in the coordinates of the input; the field's box if the samples were not kept.
  Box3 bounds() const;
  /// Number of stored samples; 0: the function can be meshed and evaluated, but not fitted again.
  std::size_t samples() const;
  /// Edits applied so far, one line each.
  const std::vector<std::string>& history() const;

  /// Internal parts, for the library's own sources; valid as long as this object.
  const FittedFunction& fitted() const { return *fitted_; }
  /// The same as a shared pointer, for the library's own sources.
  const std::shared_ptr<const FittedFunction>& shared() const { return fitted_; }

 private:
  std::shared_ptr<const FittedFunction> fitted_;
};

/// Whether the name is that of a function file (.smf, .smf.gz).
SANSMESH_API bool is_function_file(const std::string& file);

/// Reads a function file (docs/formats/smf.md). Functions and supports stay in the file, mapped into memory; samples
/// are copied. Throws FileError if the file is missing, not a function file, truncated, damaged or from a newer
/// version.
SANSMESH_API SurfaceFunction read_function(const std::string& file);

/// Writes a function file atomically. Throws FileError. `with_samples` = false omits the samples: the file is smaller,
/// but the function cannot be fitted again.
SANSMESH_API void write_function(const std::string& file, const SurfaceFunction& function, bool with_samples = true);

}  // namespace sansmesh::inline v1
