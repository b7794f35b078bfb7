// VTK text files for tests of the module that reads them.
#pragma once

#include <string>
#include <vector>

#include "volume_test_tools.h"

namespace sansmesh::test {

template <class T>
std::string words(const std::vector<T>& values) {
  std::ostringstream s;
  s.precision(17);
  for (const T& v : values) s << v << ' ';
  return s.str();
}

inline std::string data_array(const std::string& type, const std::string& name, std::size_t components,
                              const std::string& values) {
  return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" + std::to_string(components) +
         "\" format=\"ascii\">" + values + "</DataArray>\n";
}

inline std::string vtk_file(const std::string& type, const std::string& content, const std::string& version = "0.1") {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"" + type + "\" version=\"" + version +
         "\" byte_order=\"LittleEndian\">\n" + content + "</VTKFile>\n";
}

/// An unstructured grid. Nodes at one position are one point. The arrays `x` of points and `cell` of cells hold their
/// number.
struct TextGrid {
  std::vector<Vec3> points;
  std::vector<long> connectivity, offsets, types, faces, face_offsets;

  void add(int type, const std::vector<Vec3>& nodes, const std::vector<std::vector<std::size_t>>& rings = {}) {
    std::vector<long> numbers;
    for (const Vec3& p : nodes) {
      const auto found = std::find_if(points.begin(), points.end(), [&](const Vec3& q) { return norm(p - q) < 1e-9; });
      numbers.push_back(found - points.begin());
      if (found == points.end()) points.push_back(p);
    }
    connectivity.insert(connectivity.end(), numbers.begin(), numbers.end());
    offsets.push_back(static_cast<long>(connectivity.size()));
    types.push_back(type);
    if (type == 42) {
      faces.push_back(static_cast<long>(rings.size()));
      for (const auto& ring : rings) {
        faces.push_back(static_cast<long>(ring.size()));
        for (const std::size_t v : ring) faces.push_back(numbers[v]);
      }
      face_offsets.push_back(static_cast<long>(faces.size()));
    } else {
      face_offsets.push_back(-1);
    }
  }
  std::vector<double> coordinates() const {
    std::vector<double> all;
    for (const Vec3& p : points) all.insert(all.end(), {p.x, p.y, p.z});
    return all;
  }
  std::string piece(const std::string& more_of_points = {}, const std::string& more_of_cells = {}) const {
    std::vector<double> x;
    std::vector<long> cell;
    for (const Vec3& p : points) x.push_back(p.x);
    for (std::size_t c = 0; c < types.size(); ++c) cell.push_back(static_cast<long>(c));
    std::string s = "<UnstructuredGrid><Piece NumberOfPoints=\"" + std::to_string(points.size()) +
                    "\" NumberOfCells=\"" + std::to_string(types.size()) + "\">\n";
    s += "<PointData>" + data_array("Float64", "x", 1, words(x)) + more_of_points + "</PointData>\n";
    s += "<CellData>" + data_array("Int32", "cell", 1, words(cell)) + more_of_cells + "</CellData>\n";
    s += "<Points>" + data_array("Float64", "Points", 3, words(coordinates())) + "</Points>\n<Cells>";
    s += data_array("Int64", "connectivity", 1, words(connectivity)) +
         data_array("Int64", "offsets", 1, words(offsets)) + data_array("UInt8", "types", 1, words(types));
    if (!faces.empty())
      s += data_array("Int64", "faces", 1, words(faces)) + data_array("Int64", "faceoffsets", 1, words(face_offsets));
    return s + "</Cells>\n</Piece></UnstructuredGrid>\n";
  }
  std::string vtu(const std::string& more_of_points = {}, const std::string& more_of_cells = {}) const {
    return vtk_file("UnstructuredGrid", piece(more_of_points, more_of_cells), "2.2");
  }
  std::string legacy() const {
    std::string s = "# vtk DataFile Version 3.0\na test\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " +
                    std::to_string(points.size()) + " double\n" + words(coordinates()) + "\nCELLS " +
                    std::to_string(types.size()) + " " + std::to_string(connectivity.size() + types.size()) + "\n";
    for (std::size_t c = 0; c < types.size(); ++c) {
      const long first = c == 0 ? 0 : offsets[c - 1];
      s += std::to_string(offsets[c] - first);
      for (long k = first; k < offsets[c]; ++k) s += " " + std::to_string(connectivity[static_cast<std::size_t>(k)]);
      s += "\n";
    }
    return s + "CELL_TYPES " + std::to_string(types.size()) + "\n" + words(types) + "\n";
  }
};

}  // namespace sansmesh::test
