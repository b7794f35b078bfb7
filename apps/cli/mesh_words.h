// Words and JSON for the mesh of a file, shared by all commands.
#pragma once

#include <string>
#include <vector>

#include "json.h"
#include "sansmesh/io.h"
#include "sansmesh/mesh/topology_words.h"

namespace sansmesh::cli {

/// What a mesh or a cloud loses on its way through: what was not read, and what the format of `output` has no room for.
std::vector<std::string> loss_words(const ReadReport& read, const std::string& output, const TriangleMesh& mesh);
std::vector<std::string> loss_words(const ReadReport& read, const std::string& output, const PointSet& points);
Json topology_json(const MeshTopology& topology);
/// Of a mesh that was written: `file`, `vertices`, `triangles`, `closed`, `boundary_edges`.
Json output_json(const std::string& file, const TriangleMesh& mesh, const MeshTopology& topology);

}  // namespace sansmesh::cli
