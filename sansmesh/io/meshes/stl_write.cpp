// STL output, binary unless text is requested or its floats would destroy the shape.
#include <fmt/core.h>

#include "sansmesh/io/output.h"

namespace sansmesh::inline v1::io {

std::vector<std::string> mesh_to_stl(const TriangleMesh& m, const WriteOptions& options) {
  const WorldCoordinates world(m.origin, m.vertices);
  const auto normal = [&](const Triangle& t) {
    const Vec3 a(m.vertices[t[0]]), b(m.vertices[t[1]]), c(m.vertices[t[2]]);
    return Vec3f(normalized(cross(b - a, c - a)));
  };
  // Binary STL has no doubles: survey coordinates would collapse to steps of decimetres, so they are written as text.
  if (options.ascii || world.float_loss() > 1e-5) {
    std::vector<std::string> parts{"solid sansmesh\n"};
    append_rows(parts, m.triangles.size(), 12 * (number_width + 1) + 120, [&](std::size_t t, char* p) {
      const Vec3f n = normal(m.triangles[t]);
      p = put(p, "facet normal ");
      p = put(put(put(put(put(p, n.x), ' '), n.y), ' '), n.z);
      p = put(p, "\nouter loop\n");
      for (const std::uint32_t corner : m.triangles[t]) p = put(world.put(put(p, "vertex "), corner, ' '), '\n');
      return put(p, "endloop\nendfacet\n");
    });
    parts.push_back("endsolid sansmesh\n");
    return parts;
  }
  if (m.triangles.size() > 0xffffffffu) throw ArgumentError("STL holds at most 4,294,967,295 triangles");
  std::string bytes(84 + 50 * m.triangles.size(), '\0');
  put(bytes.data(), "binary STL by sansmesh");
  const std::uint32_t count = static_cast<std::uint32_t>(m.triangles.size());
  std::memcpy(bytes.data() + 80, &count, 4);
  parallel_for(0, m.triangles.size(), 1 << 13, [&](std::size_t t) {
    const Triangle& corners = m.triangles[t];
    const Vec3f record[4] = {normal(corners), world.world_float(corners[0]), world.world_float(corners[1]),
                             world.world_float(corners[2])};
    std::memcpy(bytes.data() + 84 + 50 * t, record, 48);
  });
  return {std::move(bytes)};
}

}  // namespace sansmesh::inline v1::io
