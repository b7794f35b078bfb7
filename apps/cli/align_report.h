// Words of alignment, for the commands that align.
#pragma once

#include "console.h"
#include "sansmesh/mesh/align_surfaces.h"
#include "sansmesh/placement.h"

namespace sansmesh::cli {

void say_alignment(const SurfaceAlignment& r, Console& console);
Json json_of_alignment(const SurfaceAlignment& r);
/// Its four rows.
Json json_of_matrix(const AffineMap& map);

}  // namespace sansmesh::cli
