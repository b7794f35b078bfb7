// Output as text: OBJ, OFF, XYZ, CSV.
#include <fmt/core.h>

#include <algorithm>

#include "sansmesh/image.h"
#include "sansmesh/io/output.h"
#include "sansmesh/io/points/output_columns.h"

namespace sansmesh::inline v1::io {
namespace {

using Colors = std::vector<std::array<std::uint8_t, 3>>;

/// "v x y z [r g b]" with colours as fractions, then "vn" lines.
void append_obj_vertices(std::vector<std::string>& parts, const WorldCoordinates& world, std::size_t n,
                         const std::vector<Vec3f>& normals, const Colors& colors) {
  append_rows(parts, n, 6 * (number_width + 1) + 3, [&](std::size_t i, char* p) {
    p = world.put(put(p, "v "), i, ' ');
    for (std::size_t k = 0; !colors.empty() && k < 3; ++k) p = put(put(p, ' '), from_byte(colors[i][k]));
    return put(p, '\n');
  });
  append_rows(parts, normals.size(), 3 * (number_width + 1) + 4, [&](std::size_t i, char* p) {
    p = put(p, "vn");
    for (std::size_t k = 0; k < 3; ++k) p = put(put(p, ' '), normals[i][k]);
    return put(p, '\n');
  });
}

/// Position, normal, colour and scalar of a point with `separator` between them.
char* put_point(char* p, const PointSet& points, const WorldCoordinates& world, std::size_t i, char separator) {
  p = world.put(p, i, separator);
  for (std::size_t k = 0; points.has_normals() && k < 3; ++k) p = put(put(p, separator), points.normals[i][k]);
  for (std::size_t k = 0; points.has_colors() && k < 3; ++k) {
    p = put(put(p, separator), static_cast<int>(points.colors[i][k]));
  }
  return p;
}

}  // namespace

std::vector<std::string> mesh_to_obj(const TriangleMesh& m, const WriteOptions&) {
  std::vector<std::string> parts;
  const WorldCoordinates world(m.origin, m.vertices);
  append_obj_vertices(parts, world, m.vertices.size(), m.normals, m.colors);
  const bool normals = !m.normals.empty();
  append_rows(parts, m.triangles.size(), 3 * 26 + 3, [&](std::size_t t, char* p) {
    *p++ = 'f';
    for (const std::uint32_t corner : m.triangles[t]) {
      p = put(put(p, ' '), corner + 1);
      if (normals) p = put(put(p, "//"), corner + 1);
    }
    return put(p, '\n');
  });
  return parts;
}

std::vector<std::string> points_to_obj(const PointSet& points, const WriteOptions&) {
  std::vector<std::string> parts;
  append_obj_vertices(parts, WorldCoordinates(points.origin, points.positions), points.size(), points.normals,
                      points.colors);
  return parts;
}

std::vector<std::string> mesh_to_off(const TriangleMesh& m, const WriteOptions&) {
  const bool normals = !m.normals.empty(), colors = !m.colors.empty();
  std::vector<std::string> parts{
      fmt::format("{}{}OFF\n{} {} 0\n", colors ? "C" : "", normals ? "N" : "", m.vertices.size(), m.triangles.size())};
  const WorldCoordinates world(m.origin, m.vertices);
  append_rows(parts, m.vertices.size(), 10 * (number_width + 1), [&](std::size_t i, char* p) {
    p = world.put(p, i, ' ');
    for (std::size_t k = 0; normals && k < 3; ++k) p = put(put(p, ' '), m.normals[i][k]);
    for (std::size_t k = 0; colors && k < 3; ++k) p = put(put(p, ' '), static_cast<int>(m.colors[i][k]));
    if (colors) p = put(p, " 255");
    return put(p, '\n');
  });
  append_rows(parts, m.triangles.size(), 40, [&](std::size_t t, char* p) {
    *p++ = '3';
    for (const std::uint32_t corner : m.triangles[t]) p = put(put(p, ' '), corner);
    return put(p, '\n');
  });
  return parts;
}

std::vector<std::string> points_to_xyz(const PointSet& points, const WriteOptions&) {
  std::vector<std::string> parts;
  const WorldCoordinates world(points.origin, points.positions);
  append_rows(parts, points.size(), 10 * (number_width + 1),
              [&](std::size_t i, char* p) { return put(put_point(p, points, world, i, ' '), '\n'); });
  return parts;
}

std::vector<std::string> points_to_csv(const PointSet& points, const WriteOptions&) {
  std::vector<std::string> names{"x", "y", "z"};
  if (points.has_normals()) names.insert(names.end(), {"nx", "ny", "nz"});
  if (points.has_colors()) names.insert(names.end(), {"red", "green", "blue"});
  const std::vector<OutputColumn> others = output_columns(points.attributes, names);
  for (const OutputColumn& c : others) names.push_back(c.name);
  std::string header;
  for (const std::string& name : names) header += (header.empty() ? "" : ",") + name;
  std::vector<std::string> parts{header + "\n"};
  const WorldCoordinates world(points.origin, points.positions);
  append_rows(parts, points.size(), (10 + others.size()) * (number_width + 1), [&](std::size_t i, char* p) {
    p = put_point(p, points, world, i, ',');
    for (const OutputColumn& c : others) p = c.put_text(put(p, ','), i);
    return put(p, '\n');
  });
  return parts;
}

std::vector<std::string> lines_to_csv(const PolylineSet& lines, const WriteOptions&) {
  std::vector<std::string> names{"line", "x", "y", "z"};
  std::vector<OutputColumn> others = output_columns(lines.attributes, names);
  const auto is_time = [](const OutputColumn& c) { return c.name == "time"; };
  std::stable_partition(others.begin(), others.end(), is_time);
  const std::size_t first = !others.empty() && is_time(others.front()) ? 1 : 0;
  std::string header = first == 1 ? "line,time,x,y,z" : "line,x,y,z";
  for (std::size_t k = first; k < others.size(); ++k) header += "," + others[k].name;
  std::vector<std::string> parts{header + "\n"};
  const WorldCoordinates world(lines.origin, lines.positions);
  std::vector<std::uint32_t> line_of(lines.positions.size());
  for (std::size_t i = 0; i < lines.size(); ++i)
    std::fill(line_of.begin() + static_cast<std::ptrdiff_t>(lines.offsets[i]),
              line_of.begin() + static_cast<std::ptrdiff_t>(lines.offsets[i + 1]), static_cast<std::uint32_t>(i));
  append_rows(parts, lines.positions.size(), (5 + others.size()) * (number_width + 1), [&](std::size_t i, char* p) {
    p = put(put(p, line_of[i]), ',');
    for (std::size_t k = 0; k < first; ++k) p = put(others[k].put_text(p, i), ',');
    p = world.put(p, i, ',');
    for (std::size_t k = first; k < others.size(); ++k) p = others[k].put_text(put(p, ','), i);
    return put(p, '\n');
  });
  return parts;
}

}  // namespace sansmesh::inline v1::io
