// What is said of how a mesh hangs together: the same by every command that looks at the mesh of a file.
#pragma once

#include <string>
#include <vector>

#include "json.h"
#include "sansmesh/io/io.h"
#include "sansmesh/mesh/mesh_topology.h"

namespace sansmesh::cli {

/// "not closed, manifold, 1 component, genus 0, 223 boundary edges in 5 loops". Closed is what encloses a volume
/// (MeshTopology::encloses), be it manifold or not.
std::string topology_words(const MeshTopology& topology);
/// "not closed (223 boundary edges)": what a mesh that is not closed lacks.
std::string open_words(const MeshTopology& topology);
/// "closed", "closed, but 12 edges of three triangles or more", "223 border edges": after something was done to it.
std::string border_words(const MeshTopology& topology);
/// What a mesh or a cloud loses on its way through: what was not read, and what the format of `output` has no room for.
std::vector<std::string> loss_words(const ReadReport& read, const std::string& output, const TriangleMesh& mesh);
std::vector<std::string> loss_words(const ReadReport& read, const std::string& output, const PointSet& points);
Json topology_json(const MeshTopology& topology);
/// Of a mesh that was written: `file`, `vertices`, `triangles`, `closed`, `boundary_edges`.
Json output_json(const std::string& file, const TriangleMesh& mesh, const MeshTopology& topology);

}  // namespace sansmesh::cli
