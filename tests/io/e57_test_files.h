// Writes E57 files for tests: any fields, packets of any size, poses.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace sansmesh::test {

/// A field of the records, with the numbers as stored in the file.
struct E57TestField {
  std::string name;
  std::string xml;  ///< attributes of its element in the prototype
  unsigned bits = 64;
  std::vector<std::uint64_t> stored = {};  ///< one number per record, below 2^bits

  static E57TestField real(const std::string& name, const std::vector<double>& values) {
    E57TestField f{name, "type=\"Float\"", 64};
    for (const double v : values) f.stored.push_back(std::bit_cast<std::uint64_t>(v));
    return f;
  }
  static E57TestField single(const std::string& name, const std::vector<double>& values) {
    E57TestField f{name, "type=\"Float\" precision=\"single\"", 32};
    for (const double v : values) f.stored.push_back(std::bit_cast<std::uint32_t>(static_cast<float>(v)));
    return f;
  }
  /// Integers of a range; `scale` makes them scaled ones.
  static E57TestField whole(const std::string& name, std::int64_t lowest, std::int64_t highest,
                            const std::vector<std::int64_t>& values, const std::string& scale = "") {
    const auto from = static_cast<std::uint64_t>(lowest), to = static_cast<std::uint64_t>(highest);
    E57TestField f{name,
                   "type=\"" + std::string(scale.empty() ? "Integer" : "ScaledInteger") + "\" minimum=\"" +
                       std::to_string(lowest) + "\" maximum=\"" + std::to_string(highest) + "\" " + scale,
                   static_cast<unsigned>(std::bit_width(to - from))};
    for (const std::int64_t v : values) f.stored.push_back(static_cast<std::uint64_t>(v) - from);
    return f;
  }
};

struct E57TestScan {
  std::vector<E57TestField> fields;
  std::string xml = {};  ///< further elements: name, pose, limits
  std::size_t bytes_per_stream =
      64;                          ///< bytes of a stream in each packet; numbers of any size continue in the next one
  bool with_other_packets = true;  ///< an index and an empty packet, too
};

inline std::uint32_t slow_crc32c(const std::string& bytes) {
  std::uint32_t crc = ~0u;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int k = 0; k < 8; ++k) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0x82f63b78u : 0u);
  }
  return ~crc;
}

template <class T>
void append_raw(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

/// Numbers joined to a stream of bits, the lowest first.
inline std::string packed_bits(const E57TestField& field) {
  std::string out((field.stored.size() * field.bits + 7) / 8, '\0');
  std::size_t at = 0;
  for (const std::uint64_t number : field.stored)
    for (unsigned b = 0; b < field.bits; ++b, ++at)
      if ((number >> b & 1) != 0) out[at / 8] = static_cast<char>(out[at / 8] | 1 << at % 8);
  return out;
}

/// One data packet with the given parts of the streams.
inline std::string e57_packet(const std::vector<std::string>& parts) {
  std::string body;
  append_raw(body, static_cast<std::uint16_t>(parts.size()));
  for (const std::string& part : parts) append_raw(body, static_cast<std::uint16_t>(part.size()));
  for (const std::string& part : parts) body += part;
  body.resize((body.size() + 4 + 3) / 4 * 4 - 4);
  std::string packet("\1\0", 2);
  append_raw(packet, static_cast<std::uint16_t>(body.size() + 3));
  return packet + body;
}

inline std::uint64_t e57_physical(std::uint64_t logical) { return logical / 1020 * 1024 + logical % 1020; }

/// Divides content into pages with checksums. Its length becomes a multiple of 1,020 bytes.
inline std::string e57_pages(std::string content) {
  content.resize((content.size() + 1019) / 1020 * 1020);
  std::string file;
  for (std::size_t at = 0; at < content.size(); at += 1020) {
    const std::string page = content.substr(at, 1020);
    const std::uint32_t crc = slow_crc32c(page);
    file += page;
    for (int k = 3; k >= 0; --k) file += static_cast<char>(crc >> 8 * k & 255);
  }
  return file;
}

/// A whole file. `xml` holds further elements of the root, `pictures` those of images2D.
inline std::string e57_file(const std::vector<E57TestScan>& scans, const std::string& xml = "",
                            const std::string& pictures = "") {
  std::string content(48, '\0');
  std::string described;
  for (const E57TestScan& scan : scans) {
    const std::uint64_t start = content.size();
    std::string section;
    // An index packet, which readers skip.
    if (scan.with_other_packets) section += std::string("\0\0\x0f\0", 4) + std::string(12, '\0');
    std::vector<std::string> streams;
    std::size_t longest = 0;
    for (const E57TestField& field : scan.fields) {
      streams.push_back(packed_bits(field));
      longest = std::max(longest, streams.back().size());
    }
    for (std::size_t at = 0; at < longest; at += scan.bytes_per_stream) {
      std::vector<std::string> parts;
      for (const std::string& stream : streams)
        parts.push_back(at < stream.size() ? stream.substr(at, scan.bytes_per_stream) : std::string());
      section += e57_packet(parts);
      if (at == 0 && scan.with_other_packets) section += std::string("\2\0\7\0\0\0\0\0", 8);  // an empty packet
    }
    content.append("\1\0\0\0\0\0\0\0", 8);
    append_raw(content, static_cast<std::uint64_t>(section.size() + 32));
    append_raw(content, e57_physical(start + 32));
    append_raw(content, std::uint64_t{0});
    content += section;
    const std::size_t records = scan.fields.empty() ? 0 : scan.fields[0].stored.size();
    described += "<vectorChild type=\"Structure\">" + scan.xml + "<points type=\"CompressedVector\" fileOffset=\"" +
                 std::to_string(e57_physical(start)) + "\" recordCount=\"" + std::to_string(records) +
                 "\"><prototype type=\"Structure\">";
    for (const E57TestField& field : scan.fields) described += "<" + field.name + " " + field.xml + "/>";
    described += "</prototype><codecs type=\"Vector\"/></points></vectorChild>";
  }
  const std::string root =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- a test --><e57Root type=\"Structure\" "
      "xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\" "
      "xmlns:nor=\"http://www.libe57.org/E57_NOR_surface_normals.txt\">"
      "<formatName type=\"String\"><![CDATA[ASTM E57 3D Imaging Data File]]></formatName>"
      "<guid type=\"String\"><![CDATA[{test}]]></guid><versionMajor type=\"Integer\">1</versionMajor>"
      "<versionMinor type=\"Integer\">0</versionMinor>" +
      xml + "<data3D type=\"Vector\" allowHeterogeneousChildren=\"1\">" + described +
      "</data3D><images2D type=\"Vector\" allowHeterogeneousChildren=\"1\">" + pictures + "</images2D></e57Root>";
  std::string header = "ASTM-E57";
  append_raw(header, std::uint32_t{1});
  append_raw(header, std::uint32_t{0});
  append_raw(header, e57_physical((content.size() + root.size() + 1019) / 1020 * 1020));
  append_raw(header, e57_physical(content.size()));
  append_raw(header, static_cast<std::uint64_t>(root.size()));
  append_raw(header, std::uint64_t{1024});
  content.replace(0, 48, header);
  return e57_pages(content + root);
}

/// A pose: quaternion w, x, y, z and translation.
inline std::string e57_pose(const std::vector<double>& q, const std::vector<double>& t) {
  const auto element = [](const char* name, double v) {
    return "<" + std::string(name) + " type=\"Float\">" + std::to_string(v) + "</" + name + ">";
  };
  return "<pose type=\"Structure\"><rotation type=\"Structure\">" + element("w", q[0]) + element("x", q[1]) +
         element("y", q[2]) + element("z", q[3]) + "</rotation><translation type=\"Structure\">" + element("x", t[0]) +
         element("y", t[1]) + element("z", t[2]) + "</translation></pose>";
}

}  // namespace sansmesh::test
