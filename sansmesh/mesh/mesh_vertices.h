// Operations on the vertices of a mesh with all their attributes: copies, interpolation, selection. Mesh operations use
// them so that no array is missed. Callers update the triangles.
#pragma once

#include <cstdint>
#include <span>

#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Marks a missing vertex in tables of indices.
constexpr std::uint32_t kNoVertex = ~std::uint32_t{0};

/// Appends a copy of a vertex; returns its index.
std::uint32_t append_vertex_copy(TriangleMesh& mesh, std::uint32_t v);

/// Appends a vertex at `position` that interpolates the properties of a and b with weights (1 − t) and t, 0 ≤ t ≤ 1
/// (normals renormalised, colours rounded, attributes as in AttributeTable); returns its index.
std::uint32_t append_vertex_between(TriangleMesh& mesh, std::uint32_t a, std::uint32_t b, float t,
                                    const Vec3f& position);

/// Appends vertices of another mesh. Arrays missing in `from` are filled with zeros, attributes with unknown values.
void append_vertices(TriangleMesh& mesh, const TriangleMesh& from, std::span<const std::uint32_t> vertices);

/// Replaces the vertices: vertex i becomes the former vertex vertices[i].
void take_vertices(TriangleMesh& mesh, std::span<const std::uint32_t> vertices);

}  // namespace sansmesh::inline v1
