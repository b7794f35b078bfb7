// Reference systems in the variable length records of LAS: WKT and GeoTIFF keys.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/data/reference_system.h"
#include "sansmesh/io/points/las_header.h"

namespace sansmesh::inline v1::io {

/// Number of the record of WKT.
inline constexpr std::uint16_t kWktRecord = 2112;

/// The system that the records state; null if they state none. Reports records that are not understood.
SharedSystem las_reference(const Input& in, const LasHeader& header);

/// Records that state a system. `wide`: for LAS 1.4, where WKT is preferred. GeoTIFF keys are those of the file that
/// was read, or state the codes.
std::vector<std::string> las_reference_records(const ReferenceSystem& system, bool wide);

}  // namespace sansmesh::inline v1::io
