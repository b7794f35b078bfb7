// Topology of a mesh as text.
#pragma once

#include <string>

#include "sansmesh/mesh_measures.h"

namespace sansmesh::inline v1 {

/// "not closed, manifold, 1 component, genus 0, 223 boundary edges in 5 loops". Closed means that the mesh encloses a
/// volume (MeshTopology::encloses), even if it is not manifold.
std::string topology_words(const MeshTopology& topology);
/// "not closed (223 boundary edges)", for a mesh that is not closed.
std::string open_words(const MeshTopology& topology);
/// "closed", "closed, but 12 edges of three triangles or more", "223 border edges": after an operation on the mesh.
std::string border_words(const MeshTopology& topology);

}  // namespace sansmesh::inline v1
