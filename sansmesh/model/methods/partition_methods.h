// Partition of unity as a surface.
#pragma once

#include "sansmesh/model/surface_method.h"
#include "sansmesh/partition/partition_of_unity.h"

namespace sansmesh::inline v1 {

/// The surface of a partition that was fitted before.
SurfaceParts partition_parts(PartitionOfUnity partition);

}  // namespace sansmesh::inline v1
