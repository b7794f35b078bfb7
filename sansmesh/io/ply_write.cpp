// PLY output. Positions are float, or double where float would lose more than 1e-7 of the extent.
#include <fmt/core.h>

#include "sansmesh/io/output.h"

namespace sansmesh::io {
namespace {

struct Vertices {
  const Vec3& origin;
  const std::vector<Vec3f>& positions;
  const std::vector<Vec3f>& normals;
  const std::vector<std::array<std::uint8_t, 3>>& colors;
  const std::vector<const Attribute*>& scalars;
  const std::vector<std::array<std::uint32_t, 3>>& triangles;
};

template <class T>
char* put_bytes(char* p, const T& value) {
  return static_cast<char*>(std::memcpy(p, &value, sizeof(T))) + sizeof(T);
}

std::vector<std::string> to_ply(const Vertices& v, const WriteOptions& options) {
  const std::size_t n = v.positions.size();
  const bool normals = !v.normals.empty(), colors = !v.colors.empty();
  const WorldCoordinates world(v.origin, v.positions);
  const bool wide = world.needs_double();

  std::string header =
      fmt::format("ply\nformat {} 1.0\nelement vertex {}\n", options.ascii ? "ascii" : "binary_little_endian", n);
  for (const char* name : {"x", "y", "z"}) header += fmt::format("property {} {}\n", wide ? "double" : "float", name);
  if (normals) header += "property float nx\nproperty float ny\nproperty float nz\n";
  if (colors) header += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  for (const Attribute* a : v.scalars) header += fmt::format("property float {}\n", a->name);
  if (!v.triangles.empty()) {
    header += fmt::format("element face {}\nproperty list uchar int vertex_indices\n", v.triangles.size());
  }
  header += "end_header\n";
  std::vector<std::string> parts{std::move(header)};

  if (options.ascii) {
    append_rows(parts, n, (10 + v.scalars.size()) * (number_width + 1) + 1, [&](std::size_t i, char* p) {
      p = world.put(p, i, ' ');
      for (int k = 0; normals && k < 3; ++k) p = put(put(p, ' '), v.normals[i][k]);
      for (int k = 0; colors && k < 3; ++k) p = put(put(p, ' '), static_cast<int>(v.colors[i][k]));
      for (const Attribute* a : v.scalars) p = put(put(p, ' '), a->values[i]);
      return put(p, '\n');
    });
    append_rows(parts, v.triangles.size(), 40, [&](std::size_t t, char* p) {
      *p++ = '3';
      for (const std::uint32_t corner : v.triangles[t]) p = put(put(p, ' '), corner);
      return put(p, '\n');
    });
    return parts;
  }

  const std::size_t record = (wide ? 24 : 12) + (normals ? 12 : 0) + (colors ? 3 : 0) + 4 * v.scalars.size();
  std::string body(n * record + v.triangles.size() * 13, '\0');
  parallel_for(0, n, 1 << 14, [&](std::size_t i) {
    char* p = body.data() + i * record;
    p = wide ? put_bytes(p, world.world(i)) : put_bytes(p, world.world_float(i));
    if (normals) p = put_bytes(p, v.normals[i]);
    if (colors) p = put_bytes(p, v.colors[i]);
    for (const Attribute* a : v.scalars) p = put_bytes(p, a->values[i]);
  });
  char* const faces = body.data() + n * record;
  parallel_for(0, v.triangles.size(), 1 << 14, [&](std::size_t t) {
    char* p = faces + t * 13;
    *p++ = 3;
    put_bytes(p, v.triangles[t]);
  });
  parts.push_back(std::move(body));
  return parts;
}

}  // namespace

std::vector<std::string> mesh_to_ply(const TriangleMesh& m, const WriteOptions& options) {
  const Attribute quality{"quality", m.quality};
  std::vector<const Attribute*> scalars;
  if (!m.quality.empty()) scalars.push_back(&quality);
  return to_ply({m.origin, m.vertices, m.normals, m.colors, scalars, m.triangles}, options);
}

std::vector<std::string> points_to_ply(const PointSet& p, const WriteOptions& options) {
  const std::vector<Triangle> no_faces;
  const Attribute confidence{"confidence", p.confidence};
  std::vector<const Attribute*> scalars;
  if (!p.confidence.empty()) scalars.push_back(&confidence);
  for (const Attribute& a : p.attributes) scalars.push_back(&a);
  return to_ply({p.origin, p.positions, p.normals, p.colors, scalars, no_faces}, options);
}

}  // namespace sansmesh::io
