// PCD output, binary or ascii; colours packed into one float field as in the Point Cloud Library.
#include <fmt/core.h>

#include "sansmesh/io/output.h"
#include "sansmesh/io/points/output_columns.h"

namespace sansmesh::inline v1::io {

std::vector<std::string> points_to_pcd(const PointSet& points, const WriteOptions& options) {
  const std::size_t n = points.size();
  const bool normals = points.has_normals(), colors = points.has_colors();
  const WorldCoordinates world(points.origin, points.positions);
  const bool wide = world.needs_double();
  std::string fields = "FIELDS x y z", sizes = "SIZE", types = "TYPE", counts = "COUNT";
  for (int k = 0; k < 3; ++k) sizes += wide ? " 8" : " 4";
  std::size_t extra = 0;
  if (normals) fields += " normal_x normal_y normal_z", extra += 3;
  if (colors) fields += " rgb", extra += 1;
  for (std::size_t k = 0; k < extra; ++k) sizes += " 4";
  for (std::size_t k = 0; k < 3 + extra; ++k) types += " F", counts += " 1";
  const std::vector<std::string> taken{"x", "y", "z", "normal_x", "normal_y", "normal_z", "rgb", "rgba"};
  const std::vector<OutputColumn> columns = output_columns(points.attributes, taken);
  for (const OutputColumn& c : columns) {
    fields += " " + c.name;
    sizes += fmt::format(" {}", size_of(c.type()));
    types += is_real(c.type()) ? " F" : is_signed(c.type()) ? " I" : " U";
    counts += " 1";
  }
  const std::string header = fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n{}\n{}\n{}\n{}\nWIDTH {}\nHEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA {}\n",
      fields, sizes, types, counts, n, n, options.ascii ? "ascii" : "binary");
  const auto packed = [&](std::size_t i) {
    const auto& c = points.colors[i];
    return std::uint32_t{c[0]} << 16 | std::uint32_t{c[1]} << 8 | std::uint32_t{c[2]};
  };
  std::vector<std::string> parts{header};
  if (options.ascii) {
    append_rows(parts, n, (8 + columns.size()) * (number_width + 1), [&](std::size_t i, char* p) {
      p = world.put(p, i, ' ');
      for (std::size_t k = 0; normals && k < 3; ++k) p = put(put(p, ' '), points.normals[i][k]);
      if (colors) p = put(put(p, ' '), packed(i));
      for (const OutputColumn& c : columns) p = c.put_text(put(p, ' '), i);
      return put(p, '\n');
    });
    return parts;
  }
  const std::size_t record = (wide ? 24 : 12) + 4 * extra + row_bytes(columns);
  std::string body(n * record, '\0');
  parallel_for(0, n, 1 << 14, [&](std::size_t i) {
    char* p = body.data() + i * record;
    p = wide ? put_bytes(p, world.world(i)) : put_bytes(p, world.world_float(i));
    if (normals) p = put_bytes(p, points.normals[i]);
    if (colors) p = put_bytes(p, packed(i));
    for (const OutputColumn& c : columns) p = c.put_bytes(p, i);
  });
  parts.push_back(std::move(body));
  return parts;
}

}  // namespace sansmesh::inline v1::io
