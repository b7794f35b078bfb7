// Sentences on fits and meshes of functions.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sansmesh/fit_options.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/points/normals/sensor_directions.h"
#include "sansmesh/surface_function.h"

namespace sansmesh::inline v1 {

/// Origin of the normals and of their signs: "normals estimated, oriented by flight lines".
std::string normals_made(bool estimated, const std::optional<OrientBy>& oriented_by);
/// Counts of the blocks of a fit, as in the published method, in two lines.
std::vector<std::string> paper_words(const PaperReport& report, const FitsOfDegree& fits);
/// Aspect ratios of the triangles before and after enhancement.
std::string aspect_words(const MeshReport& report);

}  // namespace sansmesh::inline v1
