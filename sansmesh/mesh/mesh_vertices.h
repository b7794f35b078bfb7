// Vertices of a mesh with all that belongs to them: copies, new ones between two, fewer. What an operation on meshes
// does to vertices it does through these, and no array is forgotten. Triangles are the caller's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// In tables of numbers of vertices: none.
constexpr std::uint32_t kNoVertex = ~std::uint32_t{0};

/// Appends a copy of a vertex; returns its index.
std::uint32_t append_vertex_copy(TriangleMesh& mesh, std::uint32_t v);

/// Appends a vertex at `position` with (1 − t) of what belongs to a and t of what belongs to b, 0 ≤ t ≤ 1 (normals
/// unit again, colours rounded, attributes as AttributeTable says); returns its index.
std::uint32_t append_vertex_between(TriangleMesh& mesh, std::uint32_t a, std::uint32_t b, float t,
                                    const Vec3f& position);

/// Appends vertices of another mesh. Arrays that `mesh` has and `from` has not are filled up with zeros, attributes
/// with what is unknown.
void append_vertices(TriangleMesh& mesh, const TriangleMesh& from, std::span<const std::uint32_t> vertices);

/// Vertex i is what vertex vertices[i] was.
void take_vertices(TriangleMesh& mesh, std::span<const std::uint32_t> vertices);

}  // namespace sansmesh::inline v1
