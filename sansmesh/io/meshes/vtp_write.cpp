// VTK XML polydata (.vtp): points or a mesh with normals, colours and attributes; raw bytes appended to the XML, or
// text.
#include <fmt/core.h>

#include <limits>

#include "sansmesh/io/meshes/vtk_xml.h"
#include "sansmesh/io/output.h"

namespace sansmesh::inline v1::io {
namespace {

/// The XML and its appended data, built array by array.
class VtpFile {
 public:
  explicit VtpFile(bool ascii) : ascii_(ascii) {}

  void line(int depth, const std::string& text) {
    xml_.append(static_cast<std::size_t>(2 * depth), ' ');
    xml_ += text + "\n";
  }

  /// Adds `numbers` numbers from at(i), with `components` per row.
  template <class At>
  void array(int depth, std::string_view name, std::size_t components, std::size_t numbers, At&& at) {
    using T = std::decay_t<decltype(at(std::size_t{}))>;
    const std::string tag = fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\"",
                                        vtk_type_name(number_type_of<T>()), to_xml(name), components);
    if (ascii_) {
      line(depth, tag + " format=\"ascii\">");
      std::vector<std::string> rows;
      append_rows(rows, numbers / components, components * (number_width + 1), [&](std::size_t r, char* p) {
        for (std::size_t c = 0; c < components; ++c)
          p = put(put(p, at(r * components + c)), c + 1 < components ? ' ' : '\n');
        return p;
      });
      for (const std::string& text : rows) xml_ += text;
      line(depth, "</DataArray>");
      return;
    }
    line(depth, fmt::format("{} format=\"appended\" offset=\"{}\"/>", tag, offset_));
    const std::uint64_t bytes = numbers * sizeof(T);
    std::string block(sizeof(bytes) + bytes, '\0');
    std::memcpy(block.data(), &bytes, sizeof(bytes));
    char* const out = block.data() + sizeof(bytes);
    parallel_for(0, numbers, 1 << 15, [&](std::size_t i) {
      const T value = at(i);
      std::memcpy(out + i * sizeof(T), &value, sizeof(T));
    });
    offset_ += block.size();
    appended_.push_back(std::move(block));
  }

  void attribute(int depth, const Attribute& a) {
    std::visit(
        [&](const auto& values) {
          array(depth, a.name, a.components, values.size(), [&](std::size_t i) { return values[i]; });
        },
        a.values);
  }

  void attributes(int depth, const char* tag, const AttributeTable& table) {
    line(depth, fmt::format("<{}>", tag));
    for (const Attribute& a : table) attribute(depth + 1, a);
    line(depth, fmt::format("</{}>", tag));
  }

  void points(int depth, const WorldCoordinates& world, std::size_t n) {
    line(depth, "<Points>");
    if (world.needs_double())
      array(depth + 1, "Points", 3, 3 * n, [&](std::size_t i) { return world.world(i / 3)[i % 3]; });
    else
      array(depth + 1, "Points", 3, 3 * n, [&](std::size_t i) { return world.world_float(i / 3)[i % 3]; });
    line(depth, "</Points>");
  }

  /// Writes everything up to the arrays of points.
  void begin(std::size_t points, std::size_t vertices, std::size_t lines, std::size_t polygons) {
    line(0, "<?xml version=\"1.0\"?>");
    line(0, "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">");
    line(1, "<PolyData>");
    line(2, fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" "
                        "NumberOfPolys=\"{}\">",
                        points, vertices, lines, polygons));
  }

  std::vector<std::string> finish() {
    line(2, "</Piece>");
    line(1, "</PolyData>");
    if (!ascii_) {
      line(1, "<AppendedData encoding=\"raw\">");
      xml_ += "   _";
      for (std::string& block : appended_) parts_.push_back(std::move(block));
    }
    parts_.front() = std::move(xml_);
    parts_.push_back(ascii_ ? "</VTKFile>\n" : "\n  </AppendedData>\n</VTKFile>\n");
    return std::move(parts_);
  }

 private:
  bool ascii_;
  std::string xml_;
  std::vector<std::string> parts_{1}, appended_;
  std::uint64_t offset_ = 0;
};

/// Indices of the smallest sufficient type.
template <class Write>
void with_index_type(std::size_t largest, Write&& write) {
  if (largest <= static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
    write(std::int32_t{});
  else
    write(std::int64_t{});
}

std::vector<std::string> to_vtp(const OutputContent& c, bool mesh, const WriteOptions& options) {
  const std::size_t n = c.positions.size(), faces = c.triangles.size();
  const WorldCoordinates world(c.origin, c.positions);
  VtpFile file(options.ascii);
  // Points without faces become one vertex cell; otherwise viewers would not draw them.
  file.begin(n, mesh ? 0 : 1, 0, faces);
  file.line(3, fmt::format("<PointData{}{}>", c.normals.empty() ? "" : " Normals=\"Normals\"",
                           c.colors.empty() ? "" : " Scalars=\"RGB\""));
  if (!c.normals.empty()) file.array(4, "Normals", 3, 3 * n, [&](std::size_t i) { return c.normals[i / 3][i % 3]; });
  if (!c.colors.empty()) file.array(4, "RGB", 3, 3 * n, [&](std::size_t i) { return c.colors[i / 3][i % 3]; });
  for (const Attribute& a : c.attributes) file.attribute(4, a);
  file.line(3, "</PointData>");
  file.attributes(3, "CellData", c.triangle_attributes);
  file.points(3, world, n);
  file.line(3, mesh ? "<Polys>" : "<Verts>");
  if (mesh) {
    with_index_type(std::max(n, 3 * faces), [&](auto index) {
      using Index = decltype(index);
      file.array(4, "connectivity", 1, 3 * faces,
                 [&](std::size_t i) { return static_cast<Index>(c.triangles[i / 3][i % 3]); });
      file.array(4, "offsets", 1, faces, [](std::size_t i) { return static_cast<Index>(3 * i + 3); });
    });
  } else {
    with_index_type(n, [&](auto index) {
      using Index = decltype(index);
      file.array(4, "connectivity", 1, n, [](std::size_t i) { return static_cast<Index>(i); });
      file.array(4, "offsets", 1, 1, [&](std::size_t) { return static_cast<Index>(n); });
    });
  }
  file.line(3, mesh ? "</Polys>" : "</Verts>");
  return file.finish();
}

}  // namespace

std::vector<std::string> mesh_to_vtp(const TriangleMesh& m, const WriteOptions& options) {
  return to_vtp(OutputContent(m), true, options);
}

std::vector<std::string> lines_to_vtp(const PolylineSet& lines, const WriteOptions& options) {
  const std::size_t n = lines.positions.size();
  const WorldCoordinates world(lines.origin, lines.positions);
  VtpFile file(options.ascii);
  file.begin(n, 0, lines.size(), 0);
  file.attributes(3, "PointData", lines.attributes);
  file.attributes(3, "CellData", lines.line_attributes);
  file.points(3, world, n);
  file.line(3, "<Lines>");
  with_index_type(n, [&](auto index) {
    using Index = decltype(index);
    file.array(4, "connectivity", 1, n, [](std::size_t i) { return static_cast<Index>(i); });
    file.array(4, "offsets", 1, lines.size(), [&](std::size_t i) { return static_cast<Index>(lines.offsets[i + 1]); });
  });
  file.line(3, "</Lines>");
  return file.finish();
}

std::vector<std::string> points_to_vtp(const PointSet& p, const WriteOptions& options) {
  return to_vtp(OutputContent(p), false, options);
}

}  // namespace sansmesh::inline v1::io
