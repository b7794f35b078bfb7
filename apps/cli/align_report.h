// Options and words of alignment, for the commands that align.
#pragma once

#include <string>
#include <vector>

#include "command_line.h"
#include "console.h"
#include "sansmesh/data/affine_map.h"
#include "sansmesh/mesh/align_surfaces.h"

namespace sansmesh::cli {

/// --from, --scale, --samples, --iterations
void add_align_options(CommandLine& command, SurfaceAlignmentOptions& options);

/// The motion, with warnings on the console. Errors of the data, and that nothing fits, are thrown as FileError that
/// name the file.
SurfaceAlignment align_or_name(const TriangleMesh& moving, const std::string& moving_file, const TriangleMesh& fixed,
                               const std::string& fixed_file, const SurfaceAlignmentOptions& options, Console& console);

AffineMap map_of(const SimilarityMotion& motion);
void say_alignment(const SurfaceAlignment& r, Console& console);
Json json_of_alignment(const SurfaceAlignment& r);
/// Its four rows.
Json json_of_matrix(const AffineMap& map);

}  // namespace sansmesh::cli
