// Files of fitted functions (.smf).
#pragma once

#include <string>

#include "sansmesh/function/surface_function.h"

namespace sansmesh::inline v1 {

class SectionFile;

/// Whether a file is a function file, by its name (.smf, .smf.gz).
bool is_function_file(const std::string& file);

/// Reads a function file (docs/formats/smf.md). Functions and supports stay in the file, mapped into memory; samples
/// are copied. Throws FileError where it is missing, not a function file, truncated, damaged or from a newer version.
SurfaceFunction read_function(const std::string& file);
/// The same of a file that is open already, or lies in memory.
SurfaceFunction read_function(const SectionFile& file);

/// Writes one, atomically. Throws FileError. `with_samples` = false leaves the samples out: smaller, but such a
/// function cannot be refitted.
void write_function(const std::string& file, const SurfaceFunction& function, bool with_samples = true);

}  // namespace sansmesh::inline v1
