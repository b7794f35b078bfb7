// Header of a PLY file: its elements and the properties of their records.
#pragma once

#include "sansmesh/io/binary.h"
#include "sansmesh/io/input.h"

namespace sansmesh::inline v1::io {

struct PlyProperty {
  std::string name;   ///< in lower case
  std::string given;  ///< as in the file
  NumberType type = NumberType::f32;
  bool is_list = false;
  NumberType count_type = NumberType::u8;
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  bool fixed() const {
    return std::none_of(properties.begin(), properties.end(), [](const PlyProperty& p) { return p.is_list; });
  }
  /// Bytes of a record whose lists are all empty.
  std::size_t least_bytes() const {
    std::size_t s = 0;
    for (const PlyProperty& p : properties) s += size_of(p.is_list ? p.count_type : p.type);
    return s;
  }
  bool holds_polygons() const { return name == "face" || name == "faces" || name == "polygon"; }
  bool holds_strips() const { return name == "tristrips" || name == "tristrip"; }
  /// The list of vertex indices, or npos.
  std::size_t index_list() const {
    for (std::size_t k = 0; k < properties.size(); ++k) {
      const PlyProperty& p = properties[k];
      if (p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index")) return k;
    }
    return std::string::npos;
  }
};

enum class PlyEncoding { ascii, little, big };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  std::string_view body;
};

/// Throws FileError if the header is malformed or has no end.
PlyHeader parse_ply_header(const Input& in);

}  // namespace sansmesh::inline v1::io
