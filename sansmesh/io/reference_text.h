// Reference systems in files without a field for them: a comment, or a file .prj beside them.
#pragma once

#include <string>
#include <string_view>

#include "sansmesh/data/reference_system.h"
#include "sansmesh/io/input.h"

namespace sansmesh::inline v1::io {

/// Begins the comment with the system in headers of PLY files.
inline constexpr std::string_view kSystemComment = "comment crs ";
/// Key of the text of the system in `asset.extras` of glTF files.
inline constexpr const char* kSystemExtra = "crs";

/// The system as one line: WKT, else "EPSG:25832"; empty for null and if neither is known.
std::string system_line(const ReferenceSystem* system);

/// System of the comment in a PLY header; null if there is none.
SharedSystem system_of_ply(std::string_view bytes);

/// System of the file .prj beside a file ("a.xyz.gz": "a.prj"); null if there is none. Warns if it cannot be used.
SharedSystem system_beside(const Input& in);

/// Writes that file, if the WKT of the system is known. Streams have none.
void write_system_beside(const std::string& file, const ReferenceSystem* system);

}  // namespace sansmesh::inline v1::io
