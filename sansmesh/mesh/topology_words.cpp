#include "sansmesh/mesh/topology_words.h"

#include <fmt/core.h>

#include "sansmesh/core/number_words.h"

namespace sansmesh::inline v1 {
namespace {

/// Open edges of two or more triangles.
std::size_t contradicting(const MeshTopology& t) { return t.open_edges - t.boundary_edges; }

std::string contradiction(const MeshTopology& t) {
  return counted(contradicting(t), "edge") + " whose faces contradict each other";
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

}  // namespace sansmesh::inline v1
