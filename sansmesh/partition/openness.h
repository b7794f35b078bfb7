// Whether the surface of a partition of unity bounds a solid or ends where its samples end: of each sheet by itself.
#pragma once

#include <optional>

#include "sansmesh/partition/partition_data.h"

namespace sansmesh {

/// From this mean winding number behind its samples on, a sheet counts as closed: its holes take less than a tenth of
/// what is seen from there. It is 1/2 behind a plane, 0.8 behind half a sphere; of closed scans and parts 0.99 to 1.07
/// have been found, with the approximation that the far field is, of terrain and depth frames 0.49 to 0.65.
constexpr double kClosedBehind = 0.9;

/// Marks the supports of the sheets that bound no solid (Support::open) and fills in what the report says of them: all,
/// none, or where `open` is not given those behind whose samples the winding number is small, be it of the sheet alone
/// or of all. Sheets that are small against the largest one follow the bulk of the others: they say little by
/// themselves.
void decide_open(std::optional<bool> open, PartitionData& data);

}  // namespace sansmesh
