// Files of fitted functions (.smf).
#pragma once

#include <string>

#include "sansmesh/function/fitted_function.h"

namespace sansmesh::inline v1 {

class SectionFile;

/// Reads a function file (docs/formats/smf.md). Functions and supports stay in the file, mapped into memory; samples
/// are copied. Throws FileError where it is missing, not a function file, truncated, damaged or from a newer version.
FittedFunction read_fitted_function(const std::string& file);
/// The same of a file that is open already, or lies in memory.
FittedFunction read_fitted_function(const SectionFile& file);

/// Writes one, atomically. Throws FileError. `with_samples` = false leaves the samples out: smaller, but such a
/// function cannot be refitted.
void write_fitted_function(const std::string& file, const FittedFunction& function, bool with_samples = true);

}  // namespace sansmesh::inline v1
