// Files of fitted volumes (.smv).
#pragma once

#include <string>

#include "sansmesh/dataset/fitted_volume.h"

namespace sansmesh::inline v1 {

class SectionFile;

/// Whether the file name is that of a fitted volume (.smv, .smv.gz).
bool is_volume_file(const std::string& file);

/// Reads a fitted volume (docs/formats/smv.md). Coefficients stay in the file, mapped into memory; samples, cells and
/// arrays are copied. Throws FileError if the file is missing, another format, truncated, damaged or of a newer
/// version.
FittedVolume read_volume_file(const std::string& file);
/// Reads an open file or a file in memory.
FittedVolume read_volume_file(const SectionFile& file);

/// Writes atomically, with the arrays that `fitted` keeps. Bytes of names that are not UTF-8 or not printable become
/// \xNN. The output does not depend on the number of threads. Throws FileError.
void write_volume_file(const std::string& file, const FittedVolume& fitted);

}  // namespace sansmesh::inline v1
