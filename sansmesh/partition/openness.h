// Whether the surface of a partition of unity bounds a solid or ends where its samples end: of each sheet by itself.
#pragma once

#include <optional>
#include <span>

#include "sansmesh/partition/partition_data.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// From this mean winding number behind its samples on, a sheet counts as closed: its holes take less than an
/// eighth of what is seen from there. It is 1/2 behind a plane, 0.8 behind half a sphere; with the approximation that
/// the far field is, 0.99 to 1.07 have been found of closed scans and parts, 0.9 of rings three spacings thin, and 0.49
/// to 0.65 of terrain and depth frames.
constexpr double kClosedBehind = 0.87;

/// Marks the supports of the sheets that bound no solid (Support::open) and fills in what the report says of them: all,
/// none, or where `open` is not given those behind whose samples the winding number is small, be it of the sheet alone
/// or together with others that are closed. Sheets that are small against the largest one, or that few samples stand
/// for, follow the bulk of the others: they say little by themselves. `samples`: along the Morton curve.
void decide_open(std::optional<bool> open, std::span<const Vec3f> samples, PartitionData& data);

}  // namespace sansmesh::inline v1
