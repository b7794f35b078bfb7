// Continuity of baked bricks.
#pragma once

#include "sansmesh/render/volume/baked_bricks.h"

namespace sansmesh::inline v1::detail {

/// Where bricks of different size meet, nodes of the finer one take the values of the coarser one. Coarse bricks come
/// first, so that the values for finer ones are final.
void close_cracks(BakedBricks& bricks);

}  // namespace sansmesh::inline v1::detail
