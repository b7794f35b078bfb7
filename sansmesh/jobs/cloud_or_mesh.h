// A cloud or a mesh, and what can be done to either.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/convert.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/point_set.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

// Each changes the data and returns what is to be said, if anything; throws DataError where that cannot be done.

/// Moves everything that is known to be a place or a direction.
std::string move_all(CloudOrMesh& data, const AffineMap& map);

/// What lies in the box, or outside of it; meshes are cut.
std::string crop_to_box(CloudOrMesh& data, const Box3& box, bool inside);

/// Makes one of vertices (or points) no farther apart than this.
std::string weld_places(CloudOrMesh& data, double distance);

/// Of a cloud points no two of which are closer than this.
std::string keep_apart(CloudOrMesh& data, double distance);

/// Of a cloud so many, drawn by chance.
std::string keep_count(CloudOrMesh& data, std::size_t count);

/// Of a cloud the first of every n.
std::string keep_every(CloudOrMesh& data, std::size_t n);

std::string flip_sides(CloudOrMesh& data, bool faces, bool normals);

/// Keeps or drops the normals, colours and attributes that the list names.
std::string choose_attributes(CloudOrMesh& data, const std::vector<std::string>& names, bool keep);

}  // namespace sansmesh::inline v1
