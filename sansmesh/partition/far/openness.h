// Decides for each sheet of a partition of unity whether it bounds a solid or ends where its samples end.
#pragma once

#include <optional>
#include <span>

#include "sansmesh/partition/partition_data.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Least mean winding number behind its samples of a closed sheet: its holes then take less than an eighth of the solid
/// angle seen from there. The exact value is 1/2 behind a plane and 0.8 behind half a sphere. With the approximate far
/// field, measured values are 0.99 to 1.07 for closed scans and parts, 0.9 for rings three spacings thin, and 0.49 to
/// 0.65 for terrain and depth frames.
constexpr double kClosedBehind = 0.87;

/// Marks the supports of the sheets that bound no solid (Support::open) and fills in their part of the report. With
/// `open` given, all sheets or none; otherwise those behind whose samples the winding number is small, both of the
/// sheet alone and together with the other closed sheets. Sheets that are small against the largest one, or that few
/// samples represent, are not judged alone but follow the majority of the others. `samples`: in the order of the Morton
/// curve.
void decide_open(std::optional<bool> open, std::span<const Vec3f> samples, std::span<const Vec3f> normals,
                 PartitionData& data);

}  // namespace sansmesh::inline v1
