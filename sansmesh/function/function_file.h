// Reads and writes files of fitted functions (.smf).
#pragma once

#include <string>

#include "sansmesh/function/fitted_function.h"

namespace sansmesh::inline v1 {

class SectionFile;

/// Reads a function file (docs/formats/smf.md). Functions and supports stay in the file, mapped into memory; samples
/// are copied. Throws FileError if the file is missing, not a function file, truncated, damaged or from a newer
/// version.
FittedFunction read_fitted_function(const std::string& file);
/// The same for a file that is open or in memory.
FittedFunction read_fitted_function(const SectionFile& file);

/// Writes a function file atomically. Throws FileError. `with_samples` = false omits the samples: the file is smaller,
/// but the function cannot be refitted.
void write_fitted_function(const std::string& file, const FittedFunction& function, bool with_samples = true);

}  // namespace sansmesh::inline v1
