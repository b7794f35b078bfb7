// Surface of a partition of unity as patches, for the far field.
#pragma once

#include <vector>

#include "sansmesh/partition/far/global_sign.h"
#include "sansmesh/partition/partition_data.h"

namespace sansmesh::inline v1 {

/// The part of the surface of each support within its block: together they tile the surface.
std::vector<OrientedPatch> support_patches(const PartitionData& data);

}  // namespace sansmesh::inline v1
