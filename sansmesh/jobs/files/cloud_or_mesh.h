// Operations on a cloud or a mesh.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/convert.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

// Each changes the data and returns a remark, which may be empty; throws DataError if the operation fails.

/// Applies a map to all positions and known directions.
std::string move_all(CloudOrMesh& data, const AffineMap& map);

/// Keeps the part inside or outside the box; meshes are cut.
std::string crop_to_box(CloudOrMesh& data, const Box3& box, bool inside);

/// Merges vertices (or points) no farther apart than this.
std::string weld_points(CloudOrMesh& data, double distance);

/// Thins a cloud so that no two points are closer than this.
std::string keep_apart(CloudOrMesh& data, double distance);

/// Thins a cloud to `count` random points.
std::string keep_count(CloudOrMesh& data, std::size_t count);

/// Keeps the first of every n points of a cloud.
std::string keep_every(CloudOrMesh& data, std::size_t n);

/// Classifies the ground of a cloud.
std::string find_ground_of(CloudOrMesh& data, Progress& progress);

std::string flip_sides(CloudOrMesh& data, bool faces, bool normals);

/// Keeps or drops the listed normals, colours and attributes.
std::string choose_attributes(CloudOrMesh& data, const std::vector<std::string>& names, bool keep);

}  // namespace sansmesh::inline v1
