#include "sansmesh/io/grids/write_cells.h"

#include <fmt/core.h>

#include <cstdint>
#include <cstring>
#include <utility>
#include <vector>

#include "sansmesh/error.h"
#include "sansmesh/io/meshes/vtk_xml.h"
#include "sansmesh/io/names.h"
#include "sansmesh/io/output.h"

namespace sansmesh::inline v1 {
namespace {

/// Tags of arrays and, in the same order, their appended bytes.
class AppendedArrays {
 public:
  template <class T>
  std::string add(const std::string& name, const std::vector<T>& values, std::size_t components) {
    std::string tag = fmt::format(
        "        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n",
        io::vtk_type_name(number_type_of<T>()), io::to_xml(name), components, offset_);
    const std::uint64_t size = values.size() * sizeof(T);
    std::string bytes(sizeof(size) + size, '\0');
    std::memcpy(bytes.data(), &size, sizeof(size));
    if (size > 0) std::memcpy(bytes.data() + sizeof(size), values.data(), size);
    offset_ += bytes.size();
    parts_.push_back(std::move(bytes));
    return tag;
  }
  std::string add(const AttributeTable& arrays) {
    std::string tags;
    for (const Attribute& a : arrays)
      tags += std::visit([&](const auto& values) { return add(a.name, values, a.components); }, a.values);
    return tags;
  }
  std::vector<std::string> take() { return std::move(parts_); }

 private:
  std::uint64_t offset_ = 0;
  std::vector<std::string> parts_;
};

}  // namespace

void write_cells(const std::string& file, std::span<const Vec3> points, const CellList& cells,
                 const AttributeTable& of_points, const AttributeTable& of_cells) {
  if (io::ending(file) != "vtu") throw FileError(file, "cells of any shape are written to files with the ending .vtu");
  of_points.check_rows(points.size(), "points");
  of_cells.check_rows(cells.size(), "cells");
  std::vector<double> positions;
  positions.reserve(3 * points.size());
  for (const Vec3& p : points) positions.insert(positions.end(), {p.x, p.y, p.z});
  constexpr std::uint8_t kTypes[] = {10, 14, 13, 12};  // VTK's numbers of the shapes
  std::vector<std::int64_t> corners, ends;
  std::vector<std::uint8_t> types;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    for (const std::uint32_t p : cells[c]) corners.push_back(p);
    ends.push_back(static_cast<std::int64_t>(corners.size()));
    types.push_back(kTypes[static_cast<std::size_t>(cells.shapes[c])]);
  }
  AppendedArrays arrays;
  std::string xml = fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
      "  <UnstructuredGrid>\n    <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n",
      points.size(), cells.size());
  xml += "      <PointData>\n" + arrays.add(of_points) + "      </PointData>\n";
  xml += "      <CellData>\n" + arrays.add(of_cells) + "      </CellData>\n";
  xml += "      <Points>\n" + arrays.add("Points", positions, 3) + "      </Points>\n";
  xml += "      <Cells>\n" + arrays.add("connectivity", corners, 1);
  xml += arrays.add("offsets", ends, 1);
  xml += arrays.add("types", types, 1);
  xml += "      </Cells>\n    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding=\"raw\">\n   _";
  std::vector<std::string> parts = arrays.take();
  parts.insert(parts.begin(), std::move(xml));
  parts.emplace_back("\n  </AppendedData>\n</VTKFile>\n");
  io::write_whole(file, parts);
}

}  // namespace sansmesh::inline v1
