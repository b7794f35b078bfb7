// Sentences on fits and meshes of functions.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sansmesh/fit_options.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/points/sights.h"
#include "sansmesh/surface_function.h"

namespace sansmesh::inline v1 {

/// Where the normals came from, and their signs: "normals estimated, oriented by flight lines".
std::string normals_made(bool estimated, const std::optional<OrientBy>& oriented_by);
/// What became of the blocks of a fit as the sources have it, in two lines.
std::vector<std::string> paper_words(const PaperReport& report, const FitsOfDegree& fits);
/// What enhancement did to the triangles.
std::string aspect_words(const MeshReport& report);

}  // namespace sansmesh::inline v1
