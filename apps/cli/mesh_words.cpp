#include "mesh_words.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

namespace sansmesh::cli {
namespace {

std::vector<std::string> words_of_losses(const ReadReport& read, const std::string& output,
                                         const std::vector<std::string>& lost) {
  std::vector<std::string> words;
  if (!read.unread.empty())
    words.push_back(fmt::format("not read, there is no place for it: {}", fmt::join(read.unread, ", ")));
  if (!lost.empty()) words.push_back(fmt::format("{} has no room for {}: left out", output, fmt::join(lost, ", ")));
  return words;
}

}  // namespace

std::vector<std::string> loss_words(const ReadReport& read, const std::string& output, const TriangleMesh& mesh) {
  return words_of_losses(read, output, left_out(output, mesh));
}

std::vector<std::string> loss_words(const ReadReport& read, const std::string& output, const PointSet& points) {
  return words_of_losses(read, output, left_out(output, points));
}

Json topology_json(const MeshTopology& t) {
  return {{"vertices", t.vertices},
          {"triangles", t.triangles},
          {"unused_vertices", t.unused_vertices},
          {"degenerate_triangles", t.degenerate_triangles},
          {"closed", t.encloses()},
          {"manifold", t.manifold()},
          // Faces that share no edge tell nothing of each other.
          {"oriented", t.edges > t.boundary_edges + t.nonmanifold_edges ? Json(t.oriented()) : Json()},
          {"boundary_edges", t.boundary_edges},
          {"boundary_loops", t.boundary_loops},
          {"open_edges", t.open_edges},
          {"nonmanifold_edges", t.nonmanifold_edges},
          {"nonmanifold_vertices", t.nonmanifold_vertices},
          {"components", t.components},
          {"largest_component", t.largest_component},
          {"euler", t.euler},
          {"genus", t.genus()}};
}

Json output_json(const std::string& file, const TriangleMesh& mesh, const MeshTopology& t) {
  return {{"file", file},
          {"vertices", mesh.vertices.size()},
          {"triangles", mesh.triangles.size()},
          {"closed", t.encloses()},
          {"boundary_edges", t.boundary_edges}};
}

}  // namespace sansmesh::cli
