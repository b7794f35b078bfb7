#include "sansmesh/mesh/mesh_vertices.h"

#include <cmath>
#include <vector>

#include "sansmesh/core/index_in.h"

namespace sansmesh::inline v1 {
namespace {

template <class T>
void append_copy(std::vector<T>& values, std::uint32_t v) {
  if (values.empty()) return;
  const T copy = values[v];
  values.push_back(copy);
}

template <class T>
void append_from(std::vector<T>& to, const std::vector<T>& from, std::span<const std::uint32_t> vertices) {
  if (to.empty()) return;
  to.reserve(to.size() + vertices.size());
  for (const std::uint32_t v : vertices) to.push_back(from.empty() ? T{} : from[v]);
}

template <class T>
void take(std::vector<T>& values, std::span<const std::uint32_t> vertices) {
  if (values.empty()) return;
  std::vector<T> result(vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) result[i] = values[vertices[i]];
  values = std::move(result);
}

}  // namespace

std::uint32_t append_vertex_copy(TriangleMesh& mesh, std::uint32_t v) {
  append_copy(mesh.vertices, v);
  append_copy(mesh.normals, v);
  append_copy(mesh.colors, v);
  mesh.attributes.append_copy(v);
  return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

std::uint32_t append_vertex_between(TriangleMesh& mesh, std::uint32_t a, std::uint32_t b, float t,
                                    const Vec3f& position) {
  mesh.vertices.push_back(position);
  if (!mesh.normals.empty()) mesh.normals.push_back(normalized(mesh.normals[a] * (1 - t) + mesh.normals[b] * t));
  if (!mesh.colors.empty()) {
    std::array<std::uint8_t, 3> color{};
    for (std::size_t k = 0; k < 3; ++k)
      color[k] = index_in<std::uint8_t>(
          std::round(static_cast<float>(mesh.colors[a][k]) * (1 - t) + static_cast<float>(mesh.colors[b][k]) * t), 0,
          255);
    mesh.colors.push_back(color);
  }
  mesh.attributes.append_between(a, b, t);
  return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

void append_vertices(TriangleMesh& mesh, const TriangleMesh& from, std::span<const std::uint32_t> vertices) {
  append_from(mesh.normals, from.normals, vertices);
  append_from(mesh.colors, from.colors, vertices);
  mesh.attributes.append(from.attributes, vertices);
  mesh.vertices.reserve(mesh.vertices.size() + vertices.size());
  for (const std::uint32_t v : vertices) mesh.vertices.push_back(from.vertices[v]);
}

void take_vertices(TriangleMesh& mesh, std::span<const std::uint32_t> vertices) {
  take(mesh.vertices, vertices);
  take(mesh.normals, vertices);
  take(mesh.colors, vertices);
  if (!mesh.attributes.empty()) mesh.attributes = mesh.attributes.taken(vertices);
}

}  // namespace sansmesh::inline v1
