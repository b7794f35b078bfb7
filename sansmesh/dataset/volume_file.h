// Files of fitted volumes (.smv).
#pragma once

#include <string>

#include "sansmesh/dataset/fitted_volume.h"

namespace sansmesh::inline v1 {

class SectionFile;

/// Whether a file is one, by its name (.smv, .smv.gz).
bool is_volume_file(const std::string& file);

/// Reads one (docs/formats/smv.md). Coefficients stay in the file, mapped into memory; samples, cells and arrays are
/// copied. Throws FileError where it is missing, no fitted volume, truncated, damaged or from a newer version.
FittedVolume read_volume_file(const std::string& file);
/// The same of a file that is open already, or lies in memory.
FittedVolume read_volume_file(const SectionFile& file);

/// Writes one, whole or not at all, with the arrays that `fitted` keeps. Bytes of names that are not UTF-8 or do not
/// print become \xNN. What is written does not depend on the number of threads. Throws FileError.
void write_volume_file(const std::string& file, const FittedVolume& fitted);

}  // namespace sansmesh::inline v1
