// Detects VTK files that announce more numbers than they hold: VTK's readers allocate the announced memory.
#pragma once

#include "sansmesh/io/input.h"

namespace sansmesh::inline v1::io {

/// Throws FileError if a VTK XML file is too short for the arrays of its header, or for those of the files that it
/// names.
void check_vtk_xml_size(const Input& in);

/// The same for the legacy format.
void check_vtk_legacy_size(const Input& in);

}  // namespace sansmesh::inline v1::io
