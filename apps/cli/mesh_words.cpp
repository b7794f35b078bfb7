#include "mesh_words.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "sansmesh/core/number_words.h"

namespace sansmesh::cli {
namespace {

/// Edges that are open although they belong to two triangles or more.
std::size_t contradicting(const MeshTopology& t) { return t.open_edges - t.boundary_edges; }

std::string contradiction(const MeshTopology& t) {
  return counted(contradicting(t), "edge") + " whose faces contradict each other";
}

std::vector<std::string> words_of_losses(const ReadReport& read, const std::string& output,
                                         const std::vector<std::string>& lost) {
  std::vector<std::string> words;
  if (!read.unread.empty())
    words.push_back(fmt::format("not read, there is no place for it: {}", fmt::join(read.unread, ", ")));
  if (!lost.empty()) words.push_back(fmt::format("{} has no room for {}: left out", output, fmt::join(lost, ", ")));
  return words;
}

}  // namespace

std::string topology_words(const MeshTopology& t) {
  std::string text = t.encloses() ? "closed" : "not closed";
  text += t.manifold() ? ", manifold"
                       : fmt::format(", not manifold ({}, {})", counted(t.nonmanifold_edges, "edge"),
                                     t.nonmanifold_vertices == 1 ? std::string("1 vertex")
                                                                 : grouped(t.nonmanifold_vertices) + " vertices");
  text += ", " + counted(t.components, "component");
  if (t.genus()) text += fmt::format(", genus {}", *t.genus());
  if (t.boundary_edges > 0)
    text += fmt::format(", {} in {}", counted(t.boundary_edges, "boundary edge"), counted(t.boundary_loops, "loop"));
  if (contradicting(t) > 0) text += ", " + contradiction(t);
  return text;
}

std::string open_words(const MeshTopology& t) {
  std::string text;
  if (t.boundary_edges > 0) text = counted(t.boundary_edges, "boundary edge");
  if (contradicting(t) > 0) text += (text.empty() ? "" : ", ") + contradiction(t);
  return "not closed (" + text + ")";
}

std::string border_words(const MeshTopology& t) {
  std::string text = t.boundary_edges > 0 ? counted(t.boundary_edges, "border edge")
                     : t.encloses()       ? "closed"
                                          : contradiction(t);
  if (t.nonmanifold_edges > 0)
    text += fmt::format(", but {} of three triangles or more", counted(t.nonmanifold_edges, "edge"));
  return text;
}

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
