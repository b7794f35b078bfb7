// How a mesh hangs together, in words.
#pragma once

#include <string>

#include "sansmesh/mesh_measures.h"

namespace sansmesh::inline v1 {

/// "not closed, manifold, 1 component, genus 0, 223 boundary edges in 5 loops". Closed is what encloses a volume
/// (MeshTopology::encloses), be it manifold or not.
std::string topology_words(const MeshTopology& topology);
/// "not closed (223 boundary edges)", of a mesh that is not.
std::string open_words(const MeshTopology& topology);
/// "closed", "closed, but 12 edges of three triangles or more", "223 border edges": after something was done to it.
std::string border_words(const MeshTopology& topology);

}  // namespace sansmesh::inline v1
