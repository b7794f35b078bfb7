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

/// The system as one line: WKT, else "EPSG:25832"; "unknown" for a system without data. Empty for null, and if neither
/// WKT nor code is known.
std::string system_line(const ReferenceSystem* system);

/// System of such a line; null if it is none. "unknown" gives a system without data: a file .prj does not count then.
SharedSystem system_of_line(std::string_view line);

/// Whether the system is one without data.
bool states_unknown(const ReferenceSystem& system);

/// System of the comment in a PLY header, as `system_of_line`; null if there is none.
SharedSystem system_of_ply(std::string_view bytes);

/// System of the file .prj beside a file ("a.xyz.gz": "a.prj"); null if there is none. Warns if it cannot be used.
SharedSystem system_beside(const Input& in);

/// Whether that file exists.
bool has_system_beside(const std::string& file);

/// Writes that file, if the WKT of the system is known. Streams have none. A file that exists stays as it is: it may
/// belong to other data of that name.
void write_system_beside(const std::string& file, const ReferenceSystem* system);

/// Warning if a file that is written there cannot hold the system, or a file .prj of other data counts for it; else
/// empty.
std::string system_remark(const std::string& file, const ReferenceSystem* system);

}  // namespace sansmesh::inline v1::io
