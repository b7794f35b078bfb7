// Files of every readable format, made byte by byte and, except for LAZ, independently of the library's writers.
#pragma once

#include <zlib.h>

#include <array>
#include <functional>

#include "compress_las.h"
#include "io_test_tools.h"

namespace sansmesh::test {

// ------------------------------------------------------------------------------------------------------- PLY

enum class Ply { ascii, little, big };

/// `value` as PLY type `type` (of the long or the short names).
inline std::string ply_value(Ply kind, const std::string& type, double value) {
  if (kind == Ply::ascii) {
    std::ostringstream s;
    s.precision(17);
    s << value << ' ';
    return s.str();
  }
  const bool big = kind == Ply::big;
  if (type == "char" || type == "int8") return raw(static_cast<std::int8_t>(value), big);
  if (type == "uchar" || type == "uint8") return raw(static_cast<std::uint8_t>(value), big);
  if (type == "short" || type == "int16") return raw(static_cast<std::int16_t>(value), big);
  if (type == "ushort" || type == "uint16") return raw(static_cast<std::uint16_t>(value), big);
  if (type == "int" || type == "int32") return raw(static_cast<std::int32_t>(value), big);
  if (type == "uint" || type == "uint32") return raw(static_cast<std::uint32_t>(value), big);
  if (type == "float" || type == "float32") return raw(static_cast<float>(value), big);
  return raw(value, big);
}

/// An element of a PLY file: properties as in the header ("float x", "list uchar int vertex_indices") and the body.
class PlyElement {
 public:
  PlyElement(std::string name, std::vector<std::string> properties)
      : name_(std::move(name)), properties_(std::move(properties)) {}

  /// One record: each property has a list of values (one, unless it is a list).
  PlyElement& add(const std::vector<std::vector<double>>& record) { return records_.push_back(record), *this; }
  /// One record of single values.
  PlyElement& row(const std::vector<double>& values) {
    std::vector<std::vector<double>> record;
    for (const double v : values) record.push_back({v});
    return add(record);
  }

  std::string header() const {
    std::string s = "element " + name_ + " " + std::to_string(records_.size()) + "\n";
    for (const std::string& p : properties_) s += "property " + p + "\n";
    return s;
  }
  std::string body(Ply kind) const {
    std::string s;
    for (const auto& record : records_) {
      for (std::size_t k = 0; k < properties_.size(); ++k) {
        std::istringstream words(properties_[k]);
        std::string type, count_type;
        words >> type;
        if (type == "list") {
          words >> count_type >> type;
          s += ply_value(kind, count_type, static_cast<double>(record[k].size()));
        }
        for (const double v : record[k]) s += ply_value(kind, type, v);
      }
      if (kind == Ply::ascii) s += '\n';
    }
    return s;
  }

 private:
  std::string name_;
  std::vector<std::string> properties_;
  std::vector<std::vector<std::vector<double>>> records_;
};

inline std::string make_ply(Ply kind, const std::vector<PlyElement>& elements) {
  std::string s = std::string("ply\nformat ") +
                  (kind == Ply::ascii    ? "ascii"
                   : kind == Ply::little ? "binary_little_endian"
                                         : "binary_big_endian") +
                  " 1.0\ncomment made for a test\n";
  for (const PlyElement& e : elements) s += e.header();
  s += "end_header\n";
  for (const PlyElement& e : elements) s += e.body(kind);
  return s;
}

/// A tetrahedron.
inline std::string tetrahedron_ply(Ply kind) {
  PlyElement v("vertex", {"float x", "float y", "float z"}), f("face", {"list uchar int vertex_indices"});
  v.row({0, 0, 0}).row({1, 0, 0}).row({0, 1, 0}).row({0, 0, 1});
  f.add({{0, 2, 1}}).add({{0, 1, 3}}).add({{1, 2, 3}}).add({{0, 3, 2}});
  return make_ply(kind, {v, f});
}

// ------------------------------------------------------------------------------------------------------- STL

inline std::string tetrahedron_stl_binary(const std::string& head = "a test") {
  const float p[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const int t[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  std::string s = head;
  s.resize(80, ' ');
  s += raw(std::uint32_t{4});
  for (const auto& corners : t) {
    s += std::string(12, '\0');
    for (const int c : corners) s.append(reinterpret_cast<const char*>(p[c]), 12);
    s += std::string(2, '\0');
  }
  return s;
}

inline std::string tetrahedron_stl_ascii() {
  const char* p[4] = {"0 0 0", "1 0 0", "0 1 0", "0 0 1"};
  const int t[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  std::string s = "solid a test\n";
  for (const auto& corners : t) {
    s += "  facet normal 0 0 0\n    outer loop\n";
    for (const int c : corners) s += std::string("      vertex ") + p[c] + "\n";
    s += "    endloop\n  endfacet\n";
  }
  return s + "endsolid a test\n";
}

// ------------------------------------------------------------------------------------------------------- PCD

/// LZF by exhaustive search in a short window.
inline std::string lzf_compress(const std::string& s) {
  std::string out, literals;
  const auto flush = [&] {
    for (std::size_t i = 0; i < literals.size(); i += 32) {
      const std::string run = literals.substr(i, 32);
      out += static_cast<char>(run.size() - 1);
      out += run;
    }
    literals.clear();
  };
  for (std::size_t i = 0; i < s.size();) {
    std::size_t best = 0, distance = 0;
    for (std::size_t d = 1; d <= std::min<std::size_t>(i, 300); ++d) {
      std::size_t length = 0;
      while (length < 264 && i + length < s.size() && s[i + length] == s[i + length - d]) ++length;
      if (length > best) best = length, distance = d;
    }
    if (best < 3) {
      literals += s[i++];
      continue;
    }
    flush();
    const std::size_t code = best - 2;
    out += static_cast<char>((std::min<std::size_t>(code, 7) << 5) | ((distance - 1) >> 8));
    if (code >= 7) out += static_cast<char>(code - 7);
    out += static_cast<char>((distance - 1) & 255);
    i += best;
  }
  flush();
  return out;
}

/// Points with normals, packed colours and an unknown field; DATA `kind`. `count` overrides POINTS.
inline std::string make_pcd(const std::string& kind, std::size_t n = 50, const std::string& count = {}) {
  const std::string points = count.empty() ? std::to_string(n) : count;
  std::string s =
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z unknown rgb normal_x normal_y normal_z\n"
      "SIZE 4 4 4 2 4 4 4 4\nTYPE F F F U U F F F\nCOUNT 1 1 1 3 1 1 1 1\nWIDTH " +
      points + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + points + "\nDATA " + kind + "\n";
  std::string columns[8];
  for (std::size_t i = 0; i < n; ++i) {
    const float x = static_cast<float>(i), y = 0.5f * x, z = 1;
    const std::string fields[8] = {raw(x),
                                   raw(y),
                                   raw(z),
                                   raw(std::uint16_t{7}) + raw(std::uint16_t{7}) + raw(std::uint16_t{7}),
                                   raw(static_cast<std::uint32_t>(0x010203 + i)),
                                   raw(0.0f),
                                   raw(i % 2 ? 1.0f : 0.0f),
                                   raw(i % 2 ? 0.0f : -1.0f)};
    if (kind == "ascii") {
      std::ostringstream line;
      line << x << ' ' << y << ' ' << z << " 7 7 7 " << 0x010203 + i << (i % 2 ? " 0 1 0\n" : " 0 0 -1\n");
      s += line.str();
    } else if (kind == "binary") {
      for (const std::string& f : fields) s += f;
    } else {
      for (int k = 0; k < 8; ++k) columns[k] += fields[k];
    }
  }
  if (kind == "binary_compressed") {
    std::string all;
    for (const std::string& c : columns) all += c;
    const std::string packed = lzf_compress(all);
    s += raw(static_cast<std::uint32_t>(packed.size())) + raw(static_cast<std::uint32_t>(all.size())) + packed;
  }
  return s;
}

// ------------------------------------------------------------------------------------------------------- LAS

/// LAS 1.`minor` of point format `format` with 20 points (i, 2i, 3i) · 0.001 + (500000, 4512345, 100).
inline std::string make_las(unsigned minor, unsigned format, std::uint64_t count = 20) {
  constexpr std::size_t record_size[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
  constexpr std::size_t color_at[] = {0, 0, 20, 28, 0, 28, 0, 30, 30, 0, 30};
  const std::size_t head = minor >= 4 ? 375 : minor == 3 ? 235 : 227, record = record_size[format] + 3;
  std::string s(head, '\0');
  const auto put = [&s](std::size_t at, const std::string& bytes) { s.replace(at, bytes.size(), bytes); };
  put(0, "LASF");
  s[24] = 1, s[25] = static_cast<char>(minor);
  put(94, raw(static_cast<std::uint16_t>(head)));
  put(96, raw(static_cast<std::uint32_t>(head + 5)));
  s[104] = static_cast<char>(format);
  put(105, raw(static_cast<std::uint16_t>(record)));
  put(107, raw(static_cast<std::uint32_t>(minor >= 4 ? 0 : count)));
  if (minor >= 4) put(247, raw(count));
  for (std::size_t k = 0; k < 3; ++k) put(131 + 8 * k, raw(0.001));
  put(155, raw(500000.0)), put(163, raw(4512345.0)), put(171, raw(100.0));
  s += "extra";
  for (std::int32_t i = 0; i < 20; ++i) {
    std::string r = raw(i) + raw(2 * i) + raw(3 * i);
    r.resize(record, '\0');
    if (const std::size_t at = color_at[format]) {
      r.replace(at, 6, raw(std::uint16_t(257 * i)) + raw(std::uint16_t(65535)) + raw(std::uint16_t(0)));
    }
    s += r;
  }
  return s;
}

// ------------------------------------------------------------------------------------------------------- VTP

inline std::string base64(const std::string& s) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < s.size(); i += 3) {
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < s.size() ? static_cast<unsigned char>(s[i + k]) : 0);
    for (std::size_t k = 0; k < 4; ++k) out += i + k > s.size() ? '=' : digits[group >> (18 - 6 * k) & 63];
  }
  return out;
}

inline std::string zlib_compress(const std::string& s) {
  uLongf size = compressBound(s.size());
  std::string out(size, '\0');
  compress(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(s.data()), s.size());
  out.resize(size);
  return out;
}

inline std::string gzip(const std::string& s) {
  z_stream z{};
  deflateInit2(&z, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  std::string out(deflateBound(&z, s.size()) + 64, '\0');
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(s.data())), z.avail_in = static_cast<uInt>(s.size());
  z.next_out = reinterpret_cast<Bytef*>(out.data()), z.avail_out = static_cast<uInt>(out.size());
  deflate(&z, Z_FINISH);
  out.resize(z.total_out);
  deflateEnd(&z);
  return out;
}

struct Vtp {
  std::string format = "ascii";  ///< ascii, binary, or appended
  bool compressed = false, wide_header = false, big = false;
  bool base64_appended = false;
  bool header_apart = false;  ///< header and data in separate base64
};

/// A square of a quad and a strip (two triangles each) in two pieces, with normals and colours.
inline std::string make_vtp(const Vtp& o) {
  std::string appended;
  const auto array = [&](const std::string& type, const std::string& name, int components,
                         const std::vector<double>& values) {
    std::string tag = "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
                      std::to_string(components) + "\" format=\"" + o.format + "\"";
    std::string bytes;
    std::ostringstream text;
    for (const double v : values) {
      text << v << ' ';
      if (type == "Float32") bytes += raw(static_cast<float>(v), o.big);
      if (type == "Float64") bytes += raw(v, o.big);
      if (type == "Int64") bytes += raw(static_cast<std::int64_t>(v), o.big);
      if (type == "Int32") bytes += raw(static_cast<std::int32_t>(v), o.big);
      if (type == "UInt8") bytes += raw(static_cast<std::uint8_t>(v));
    }
    if (o.format == "ascii") return tag + ">\n" + text.str() + "\n</DataArray>\n";
    const auto number = [&](std::size_t v) {
      return o.wide_header ? raw(static_cast<std::uint64_t>(v), o.big) : raw(static_cast<std::uint32_t>(v), o.big);
    };
    std::string header, data;
    if (o.compressed) {
      const std::size_t block = 16;  // several blocks, the last one partial
      std::size_t blocks = 0;
      std::string sizes;
      for (std::size_t i = 0; i < bytes.size(); i += block, ++blocks) {
        const std::string packed = zlib_compress(bytes.substr(i, block));
        sizes += number(packed.size()), data += packed;
      }
      header = number(blocks) + number(block) + number(bytes.size() % block) + sizes;
    } else {
      header = number(bytes.size()), data = bytes;
    }
    const std::string encoded = o.compressed || o.header_apart ? base64(header) + base64(data) : base64(header + data);
    if (o.format == "binary") return tag + ">\n  " + encoded + "\n</DataArray>\n";
    tag += " offset=\"" + std::to_string(appended.size()) + "\"/>\n";
    appended += o.base64_appended ? encoded : header + data;
    return tag;
  };
  std::string s =
      "<?xml version=\"1.0\"?>\n<!-- a <test> -->\n<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"" +
      std::string(o.big ? "BigEndian" : "LittleEndian") + "\"" + (o.wide_header ? " header_type=\"UInt64\"" : "") +
      (o.compressed ? " compressor=\"vtkZLibDataCompressor\"" : "") + ">\n<PolyData>\n";
  for (int piece = 0; piece < 2; ++piece) {
    const double x = piece;
    s += "<Piece NumberOfPoints=\"4\">\n<PointData Normals=\"up\">\n";
    s += array("Float32", "up", 3, {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});
    s += array("UInt8", "rgb", 3, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 255});
    s += "</PointData>\n<CellData>\n" + array("Float32", "area", 1, {1}) + "</CellData>\n<Points>\n";
    s += array(piece ? "Float64" : "Float32", "Points", 3, {x, 0, 0, x + 1, 0, 0, x + 1, 1, 0, x, 1, 0});
    s += "</Points>\n<Verts>\n" + array("Int32", "connectivity", 1, {0}) + array("Int32", "offsets", 1, {1}) +
         "</Verts>\n";
    if (piece == 0) {
      s += "<Polys>\n" + array("Int64", "connectivity", 1, {0, 1, 2, 3}) + array("Int64", "offsets", 1, {4}) +
           "</Polys>\n";
    } else {
      s += "<Strips>\n" + array("Int32", "connectivity", 1, {0, 1, 3, 2}) + array("Int32", "offsets", 1, {4}) +
           "</Strips>\n";
    }
    s += "</Piece>\n";
  }
  s += "</PolyData>\n";
  if (o.format == "appended") {
    s += std::string("<AppendedData encoding=\"") + (o.base64_appended ? "base64" : "raw") + "\">\n_" + appended +
         "\n</AppendedData>\n";
  }
  return s + "</VTKFile>\n";
}

// ------------------------------------------------------------------------------------------------------- all

struct SampleFile {
  std::string name;
  std::string content;
  bool binary;  ///< truncation at any byte is detectable
};

inline std::vector<SampleFile> sample_files() {
  return {{"ascii.ply", tetrahedron_ply(Ply::ascii), false},
          {"little.ply", tetrahedron_ply(Ply::little), true},
          {"big.ply", tetrahedron_ply(Ply::big), true},
          {"a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nf 1/1 3/1 2/1\nf 1 2 4\nf 2 3 4\nf 1 4 3\n", false},
          {"a.off", "OFF\n4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n", false},
          {"ascii.stl", tetrahedron_stl_ascii(), false},
          {"binary.stl", tetrahedron_stl_binary(), true},
          {"a.xyz", "0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n1 1 0 0 0 1\n", false},
          {"a.csv", "x,y,z\n0,0,0\n1,0,0\n0,1,0\n", false},
          {"a.pwn", "3\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 1\n0 0 1\n", false},
          {"ascii.pcd", make_pcd("ascii"), false},
          {"binary.pcd", make_pcd("binary"), true},
          {"compressed.pcd", make_pcd("binary_compressed"), true},
          {"12.las", make_las(2, 3), true},
          {"14.las", make_las(4, 7), true},
          {"12.laz", compress_las(make_las(2, 3), 7), true},
          {"14.laz", compress_las(make_las(4, 7), 7), true},
          {"ascii.vtp", make_vtp({}), false},
          {"binary.vtp", make_vtp({.format = "binary"}), false},
          {"appended.vtp", make_vtp({.format = "appended", .compressed = true}), false},
          {"packed.ply.gz", gzip(tetrahedron_ply(Ply::little)), true},
          {"a.conf", "camera 0 0 0 0 0 0 1\nbmesh little.ply 0 0 0 0 0 0 1\nbmesh ascii.ply 1 2 3 0 0 0 1\n", false}};
}

}  // namespace sansmesh::test
