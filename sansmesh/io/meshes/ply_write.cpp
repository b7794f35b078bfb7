// PLY output. Positions are float, or double if float would lose more than 1e-7 of the extent.
#include <fmt/core.h>

#include "sansmesh/io/output.h"
#include "sansmesh/io/points/output_columns.h"
#include "sansmesh/io/reference_text.h"

namespace sansmesh::inline v1::io {
namespace {

/// The names of 64-bit types are not in the format's first description; readers that do not know them report an error.
const char* ply_type(NumberType type) {
  constexpr const char* names[] = {"char", "uchar", "short",  "ushort", "int",
                                   "uint", "int64", "uint64", "float",  "double"};
  return names[static_cast<std::size_t>(type)];
}

std::vector<std::string> to_ply(const OutputContent& v, const WriteOptions& options) {
  const std::size_t n = v.positions.size();
  const bool normals = !v.normals.empty(), colors = !v.colors.empty();
  const WorldCoordinates world(v.origin, v.positions);
  const bool wide = world.needs_double();

  std::string header = fmt::format("ply\nformat {} 1.0\n", options.ascii ? "ascii" : "binary_little_endian");
  if (const std::string system = system_line(v.reference); !system.empty())
    header += std::string(kSystemComment) + system + "\n";
  header += fmt::format("element vertex {}\n", n);
  std::vector<std::string> taken;
  const auto property = [&](const char* type, const std::string& name) {
    header += fmt::format("property {} {}\n", type, name);
    taken.push_back(name);
  };
  for (const char* name : {"x", "y", "z"}) property(wide ? "double" : "float", name);
  for (const char* name : {"nx", "ny", "nz"}) {
    if (normals) property("float", name);
  }
  for (const char* name : {"red", "green", "blue"}) {
    if (colors) property("uchar", name);
  }
  const std::vector<OutputColumn> scalars = output_columns(v.attributes, taken);
  for (const OutputColumn& c : scalars) property(ply_type(c.type()), c.name);
  std::vector<OutputColumn> of_faces;
  if (!v.triangles.empty()) {
    of_faces = output_columns(v.triangle_attributes, {"vertex_indices"});
    header += fmt::format("element face {}\nproperty list uchar int vertex_indices\n", v.triangles.size());
    for (const OutputColumn& c : of_faces) property(ply_type(c.type()), c.name);
  }
  header += "end_header\n";
  std::vector<std::string> parts{std::move(header)};

  if (options.ascii) {
    append_rows(parts, n, (10 + scalars.size()) * (number_width + 1) + 1, [&](std::size_t i, char* p) {
      p = world.put(p, i, ' ');
      for (int k = 0; normals && k < 3; ++k) p = put(put(p, ' '), v.normals[i][k]);
      for (int k = 0; colors && k < 3; ++k) p = put(put(p, ' '), static_cast<int>(v.colors[i][k]));
      for (const OutputColumn& c : scalars) p = c.put_text(put(p, ' '), i);
      return put(p, '\n');
    });
    append_rows(parts, v.triangles.size(), 40 + of_faces.size() * (number_width + 1), [&](std::size_t t, char* p) {
      *p++ = '3';
      for (const std::uint32_t corner : v.triangles[t]) p = put(put(p, ' '), corner);
      for (const OutputColumn& c : of_faces) p = c.put_text(put(p, ' '), t);
      return put(p, '\n');
    });
    return parts;
  }

  const std::size_t record = (wide ? 24 : 12) + (normals ? 12 : 0) + (colors ? 3 : 0) + row_bytes(scalars);
  const std::size_t face = 13 + row_bytes(of_faces);
  std::string body(n * record + v.triangles.size() * face, '\0');
  parallel_for(0, n, 1 << 14, [&](std::size_t i) {
    char* p = body.data() + i * record;
    p = wide ? put_bytes(p, world.world(i)) : put_bytes(p, world.world_float(i));
    if (normals) p = put_bytes(p, v.normals[i]);
    if (colors) p = put_bytes(p, v.colors[i]);
    for (const OutputColumn& c : scalars) p = c.put_bytes(p, i);
  });
  char* const faces = body.data() + n * record;
  parallel_for(0, v.triangles.size(), 1 << 14, [&](std::size_t t) {
    char* p = faces + t * face;
    *p++ = 3;
    p = put_bytes(p, v.triangles[t]);
    for (const OutputColumn& c : of_faces) p = c.put_bytes(p, t);
  });
  parts.push_back(std::move(body));
  return parts;
}

}  // namespace

std::vector<std::string> mesh_to_ply(const TriangleMesh& m, const WriteOptions& options) {
  return to_ply(OutputContent(m), options);
}

std::vector<std::string> lines_to_ply(const PolylineSet& lines, const WriteOptions& options) {
  // The vertices of a cloud, then the edges.
  PointSet points;
  points.origin = lines.origin, points.reference = lines.reference, points.positions = lines.positions,
  points.attributes = lines.attributes;
  std::vector<std::string> parts = to_ply(OutputContent(points), options);
  std::vector<std::array<std::uint32_t, 2>> edges;
  edges.reserve(lines.positions.size());
  for (std::size_t i = 0; i < lines.size(); ++i)
    for (std::size_t k = lines.offsets[i]; k + 1 < lines.offsets[i + 1]; ++k)
      edges.push_back({static_cast<std::uint32_t>(k), static_cast<std::uint32_t>(k + 1)});
  std::string& header = parts.front();
  header.insert(header.rfind("end_header\n"),
                fmt::format("element edge {}\nproperty int vertex1\nproperty int vertex2\n", edges.size()));
  if (options.ascii) {
    append_rows(parts, edges.size(), 40,
                [&](std::size_t i, char* p) { return put(put(put(put(p, edges[i][0]), ' '), edges[i][1]), '\n'); });
    return parts;
  }
  std::string body(edges.size() * sizeof(edges[0]), '\0');
  if (!edges.empty()) std::memcpy(body.data(), edges.data(), body.size());
  parts.push_back(std::move(body));
  return parts;
}

std::vector<std::string> points_to_ply(const PointSet& p, const WriteOptions& options) {
  return to_ply(OutputContent(p), options);
}

}  // namespace sansmesh::inline v1::io
