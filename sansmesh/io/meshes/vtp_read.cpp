// VTK XML polydata (.vtp): points, polygons, strips, normals, colours and attributes of points and cells, inline or
// appended, as text, base64 or raw bytes, plain or compressed by zlib.
#include <fmt/core.h>

#include <optional>

#include "sansmesh/box.h"
#include "sansmesh/core/index_in.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/core/option_text.h"
#include "sansmesh/io/color_bytes.h"
#include "sansmesh/io/inflate.h"
#include "sansmesh/io/meshes/face_sink.h"
#include "sansmesh/io/meshes/line_input.h"
#include "sansmesh/io/meshes/vtk_xml.h"
#include "sansmesh/io/points/assemble_points.h"
#include "sansmesh/io/points/columns.h"
#include "sansmesh/io/readers.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {
namespace {

struct Array {
  std::string name;
  NumberType type = NumberType::f32;
  NumberType declared = NumberType::f32;  ///< type in the file; text is read into wider numbers
  std::size_t components = 1;
  bool swap = false;
  std::vector<char> bytes;

  std::size_t count() const { return bytes.size() / size_of(type); }
  Column column(std::size_t component) const {
    return {bytes.data() + component * size_of(type), components * size_of(type), type, swap};
  }
  NamedColumns columns() const {
    NamedColumns c{name, declared, {}};
    for (std::size_t k = 0; k < components; ++k) c.components.push_back(column(k));
    return c;
  }
  std::vector<std::int64_t> integers() const {
    std::vector<std::int64_t> v(count());
    with_loader(type, swap, [&](auto at) {
      for (std::size_t i = 0; i < v.size(); ++i) {
        const auto number = at(bytes.data() + i * size_of(type));
        if constexpr (std::is_floating_point_v<std::decay_t<decltype(number)>>)
          v[i] = whole_part<std::int64_t>(number);
        else
          v[i] = static_cast<std::int64_t>(number);
      }
    });
    return v;
  }
};

/// Arrays with more numbers per row are not read as attributes.
constexpr std::size_t kMostComponents = 4096;

class VtpReader {
 public:
  explicit VtpReader(const Input& in) : in_(in) {}

  PointSet read() {
    scan();
    if (pieces_.empty()) in_.fail("holds no points");
    return assemble();
  }

  /// The lines of all pieces, if there are any.
  PolylineSet read_lines() {
    lines_wanted_ = true;
    scan();
    PolylineSet lines;
    std::vector<AttributeTable> tables;
    std::vector<std::uint32_t> rows;
    std::vector<Vec3> positions;
    std::size_t first = 0;
    for (const Piece& p : pieces_) {
      const std::size_t n = p.points->count() / 3;
      const Column x = p.points->column(0), y = p.points->column(1), z = p.points->column(2);
      add_cells(p.line_connectivity, p.line_offsets, 0, n, [&](std::span<const std::int64_t> points) {
        if (points.empty()) return;
        for (const std::int64_t i : points) {
          const auto k = static_cast<std::size_t>(i);
          positions.push_back({x[k], y[k], z[k]});
          rows.push_back(static_cast<std::uint32_t>(first + k));
        }
        lines.offsets.push_back(positions.size());
      });
      tables.push_back(decode(p.of_points, n, 0, "points"));
      first += n;
    }
    if (positions.empty()) return lines;
    place_lines(lines, positions);
    lines.attributes = join_tables(in_, std::move(tables), "pieces").taken(rows);
    return lines;
  }

 private:
  void scan() {
    find_appended();
    XmlScanner xml(in_);
    bool is_polydata = false;
    bool ended = false;
    std::string_view section;
    while (auto tag = xml.next()) {
      if (tag->name == "VTKFile") {
        if ((*tag)["type"] != "PolyData")
          in_.fail(fmt::format("is VTK XML of type '{}'; PolyData is read", (*tag)["type"]));
        is_polydata = true;
        swap_ = (*tag)["byte_order"] == "BigEndian";
        wide_header_ = (*tag)["header_type"] == "UInt64";
        compressor_ = (*tag)["compressor"];
        if (!compressor_.empty() && compressor_ != "vtkZLibDataCompressor") {
          in_.fail(fmt::format("unsupported compression '{}' (zlib is read)", compressor_));
        }
      } else if (tag->name == "Piece") {
        piece_ = {};
        TextScanner((*tag)["NumberOfVerts"]).number(piece_.other_cells);
        std::size_t lines = 0;
        TextScanner((*tag)["NumberOfLines"]).number(lines);
        piece_.other_cells += lines;
      } else if (tag->name == "/Piece") {
        add_piece();
      } else if (tag->name == "AppendedData" || tag->name == "/VTKFile") {
        ended = true;
        break;
      } else if (tag->name == "PointData") {
        section = tag->closed ? std::string_view() : tag->name;
        piece_.normals_name = (*tag)["Normals"];
        piece_.scalars_name = (*tag)["Scalars"];
      } else if (tag->name == "Points" || tag->name == "Polys" || tag->name == "Strips" || tag->name == "Lines" ||
                 tag->name == "CellData") {
        section = tag->closed ? std::string_view() : tag->name;
      } else if (tag->name == "DataArray" && !section.empty()) {
        data_array(*tag, section, xml.text());
      } else if ((tag->name.starts_with('/') && tag->name.substr(1) == section) || tag->name == "FieldData" ||
                 tag->name == "Verts") {
        section = {};
      }
    }
    if (!is_polydata) in_.fail("is not a VTK XML file");
    if (!ended) in_.fail("truncated: the XML ends before </VTKFile>");
  }

  struct Piece {
    std::optional<Array> points, normals, colors, poly_connectivity, poly_offsets, strip_connectivity, strip_offsets,
        line_connectivity, line_offsets;
    std::vector<Array> of_points, of_cells;
    std::string_view normals_name, scalars_name;
    std::size_t other_cells = 0;  ///< vertices and lines before the polygons
  };

  void find_appended() {
    const std::size_t tag = in_.bytes.find("<AppendedData");
    if (tag == std::string_view::npos) return;
    const std::size_t close = in_.bytes.find('>', tag);
    const std::size_t mark = in_.bytes.find('_', close);
    if (close == std::string_view::npos || mark == std::string_view::npos)
      in_.fail("truncated: the appended data is missing");
    appended_base64_ = in_.bytes.substr(tag, close - tag).find("base64") != std::string_view::npos;
    appended_ = in_.bytes.substr(mark + 1);
  }

  void data_array(const XmlTag& tag, std::string_view section, std::string_view text) {
    const std::string_view name = tag["Name"];
    std::optional<Array>* target = nullptr;
    std::size_t components = 1;
    TextScanner(tag["NumberOfComponents"]).number(components);
    const std::string lower_name = lower_case(name);
    if (section == "Points")
      target = &piece_.points;
    else if (section == "Polys" && name == "connectivity")
      target = &piece_.poly_connectivity;
    else if (section == "Polys" && name == "offsets")
      target = &piece_.poly_offsets;
    else if (section == "Strips" && name == "connectivity")
      target = &piece_.strip_connectivity;
    else if (section == "Strips" && name == "offsets")
      target = &piece_.strip_offsets;
    else if (lines_wanted_ && section == "Lines" && name == "connectivity")
      target = &piece_.line_connectivity;
    else if (lines_wanted_ && section == "Lines" && name == "offsets")
      target = &piece_.line_offsets;
    else if (section == "PointData" && components == 3 &&
             (name == piece_.normals_name || (piece_.normals_name.empty() && lower_name == "normals")))
      target = &piece_.normals;
    else if (section == "PointData" && !piece_.colors && (components == 3 || components == 4) &&
             tag["type"] == "UInt8" && names_colors(lower_name, name))
      target = &piece_.colors;
    const bool attribute = !target && (section == "PointData" || section == "CellData");
    if (attribute ? !vtk_type_of_name(tag["type"]) || components == 0 || components > kMostComponents
                  : !target || *target)
      return;
    if (section == "Points" && components != 3) in_.fail("malformed VTP: points without 3 components");

    Array array;
    array.name = from_xml(name);
    array.components = components;
    array.type = array.declared = parse_type(tag["type"]);
    const std::string_view format = tag["format"];
    if (format == "ascii") {
      read_text(array, text);
    } else if (format == "binary") {
      array.swap = swap_;
      const std::vector<char> bytes = decode_base64(text);
      unpack(array, {bytes.data(), bytes.size()});
    } else if (format == "appended") {
      array.swap = swap_;
      std::size_t offset = 0;
      if (!TextScanner(tag["offset"]).number(offset)) in_.fail("malformed VTP: an array without its offset");
      if (offset > appended_.size()) in_.fail_short(offset, appended_.size(), true);
      const std::string_view data = appended_.substr(offset);
      if (appended_base64_) {
        const std::vector<char> bytes = decode_base64(data.substr(0, base64_extent(data)));
        unpack(array, {bytes.data(), bytes.size()});
      } else {
        unpack(array, data);
      }
    } else {
      in_.fail(fmt::format("malformed VTP: unknown format '{}' of an array", format));
    }
    if (attribute)
      (section == "CellData" ? piece_.of_cells : piece_.of_points).push_back(std::move(array));
    else
      *target = std::move(array);
  }

  /// Whether bytes with this name are colours: other triples of bytes are attributes.
  bool names_colors(const std::string& lower_name, std::string_view name) const {
    const auto has = [&](const char* word) { return lower_name.find(word) != std::string::npos; };
    return name.empty() || name == piece_.scalars_name || has("color") || has("colour") || has("rgb") || has("diffuse");
  }

  NumberType parse_type(std::string_view t) const {
    if (const auto type = vtk_type_of_name(t)) return *type;
    in_.fail(fmt::format("malformed VTP: unknown type '{}' of an array", t));
  }

  void read_text(Array& array, std::string_view text) const {
    const bool whole = !is_real(array.type);
    array.type = array.type == NumberType::u64 ? NumberType::u64 : whole ? NumberType::i64 : NumberType::f64;
    TextScanner words(text);
    for (words.skip_space(); !words.at_end(); words.skip_space()) {
      double cell = 0;
      if (!read_cell(words, array.type, cell)) {
        in_.fail(fmt::format("malformed VTP: '{}' is not a number", words.word().substr(0, 40)));
      }
      const char* p = reinterpret_cast<const char*>(&cell);
      array.bytes.insert(array.bytes.end(), p, p + 8);
    }
  }

  std::uint64_t header_value(std::string_view data, std::size_t k) const {
    const std::size_t size = wide_header_ ? 8 : 4;
    if (data.size() / size < k + 1) in_.fail("truncated: an array ends inside its header");
    const char* p = data.data() + k * size;
    if (wide_header_) return swap_ ? load<std::uint64_t, true>(p) : load<std::uint64_t>(p);
    return swap_ ? load<std::uint32_t, true>(p) : load<std::uint32_t>(p);
  }

  /// Number of base64 characters of the array at the start of `text`.
  std::size_t base64_extent(std::string_view text) const {
    const std::size_t size = wide_header_ ? 8 : 4;
    const auto encoded = [](std::uint64_t bytes) { return (bytes + 2) / 3 * 4; };
    const auto decoded = [&](std::size_t bytes) { return decode_base64(text.substr(0, encoded(bytes))); };
    const std::vector<char> first = decoded(size);
    const std::uint64_t value = header_value({first.data(), first.size()}, 0);
    if (value > text.size()) return text.size();
    // Some writers encode header and data together, some separately, which takes slightly more.
    if (compressor_.empty()) return encoded(size) + encoded(value);
    const std::size_t header = size * (3 + static_cast<std::size_t>(value));
    const std::vector<char> sizes = decoded(header);
    std::uint64_t packed = 0;
    for (std::size_t b = 0; b < value; ++b) packed += header_value({sizes.data(), sizes.size()}, 3 + b);
    return packed > text.size() ? text.size() : encoded(header) + encoded(packed);
  }

  /// Decodes header and data. Uncompressed data have the header: bytes. Compressed: blocks, bytes per block, bytes of
  /// the last one (0 = full), packed bytes of each.
  void unpack(Array& array, std::string_view data) {
    const std::size_t size = wide_header_ ? 8 : 4;
    if (compressor_.empty()) {
      const std::uint64_t bytes = header_value(data, 0);
      data.remove_prefix(size);
      if (bytes > data.size()) in_.fail_short(bytes, data.size(), true);
      count_taken(bytes);
      array.bytes.assign(data.begin(), data.begin() + static_cast<std::ptrdiff_t>(bytes));
      return;
    }
    const std::uint64_t blocks = header_value(data, 0);
    if (blocks == 0) return;
    const std::uint64_t block = header_value(data, 1), partial = header_value(data, 2);
    if (blocks > data.size() / size || block > (std::uint64_t{1} << 32) || partial > block) {
      in_.fail("truncated or damaged: an array announces more blocks than the file holds");
    }
    std::size_t at = size * (3 + static_cast<std::size_t>(blocks));
    const auto packed_size = [&](std::uint64_t b) { return header_value(data, 3 + static_cast<std::size_t>(b)); };
    const auto wanted_size = [&](std::uint64_t b) {
      return static_cast<std::size_t>(b + 1 == blocks && partial > 0 ? partial : block);
    };
    std::uint64_t all = 0, end = at;
    for (std::uint64_t b = 0; b < blocks; ++b) {
      const std::uint64_t packed = packed_size(b), wanted = wanted_size(b);
      if (end > data.size() || packed > data.size() - end)
        in_.fail(fmt::format("truncated: ends inside the blocks of an array (block {} of {} has {} bytes)",
                             grouped(b + 1), grouped(blocks), grouped(packed)));
      if (wanted > packed * kMostExpansion)
        in_.fail(fmt::format("damaged compressed data: a block announces {} bytes, more than its {} packed ones hold",
                             grouped(wanted), grouped(packed)));
      all += wanted, end += packed;
    }
    count_taken(end);
    array.bytes.reserve(all);
    for (std::uint64_t b = 0; b < blocks; ++b) {
      const std::uint64_t packed = packed_size(b);
      const std::size_t wanted = wanted_size(b);
      const Inflated out =
          inflate_bytes(in_.file, data.substr(at, static_cast<std::size_t>(packed)), wanted + 1, wanted + 1);
      if (!out.complete || out.bytes.size() != wanted) in_.fail("damaged compressed data (a block has another size)");
      array.bytes.insert(array.bytes.end(), out.bytes.begin(), out.bytes.end());
      at += static_cast<std::size_t>(packed);
    }
  }

  /// No two arrays may share bytes: otherwise a small file could expand without limit.
  void count_taken(std::uint64_t bytes) {
    taken_ += bytes;
    if (taken_ > in_.bytes.size())
      in_.fail(fmt::format("malformed VTP: its arrays overlap: they take at least {} of its {} bytes", grouped(taken_),
                           grouped(in_.bytes.size())));
  }

  void add_piece() {
    if (piece_.points && piece_.points->count() > 0) {
      if (piece_.points->count() % 3 != 0) in_.fail("malformed VTP: the points are not triples");
      pieces_.push_back(std::move(piece_));
    }
    piece_ = {};
  }

  PointSet assemble() {
    PointSet points;
    std::vector<std::uint32_t> face_of;
    const bool cells_known =
        std::any_of(pieces_.begin(), pieces_.end(), [](const Piece& p) { return !p.of_cells.empty(); });
    FaceSink sink(in_, points.triangles, cells_known ? &face_of : nullptr);
    std::vector<AttributeTable> of_points, of_faces;
    std::vector<Vec3> positions;
    bool normals = true, colors = true;
    for (const Piece& p : pieces_) {
      const std::size_t n = p.points->count() / 3;
      normals &= p.normals && p.normals->count() == 3 * n;
      colors &= p.colors && p.colors->count() == p.colors->components * n;
    }
    for (const Piece& p : pieces_) {
      const std::size_t first = positions.size();
      const std::size_t n = p.points->count() / 3;
      const Column x = p.points->column(0), y = p.points->column(1), z = p.points->column(2);
      for (std::size_t i = 0; i < n; ++i) positions.push_back({x[i], y[i], z[i]});
      for (std::size_t i = 0; normals && i < n; ++i) {
        points.normals.push_back(
            Vec3f(Vec3{p.normals->column(0)[i], p.normals->column(1)[i], p.normals->column(2)[i]}));
      }
      for (std::size_t i = 0; colors && i < n; ++i) {
        const auto byte = [&](std::size_t k) { return to_byte(p.colors->column(k)[i], 1); };
        points.colors.push_back({byte(0), byte(1), byte(2)});
      }
      add_cells(p.poly_connectivity, p.poly_offsets, first, n, [&](auto corners) { sink.add_polygon(corners); });
      add_cells(p.strip_connectivity, p.strip_offsets, first, n, [&](auto corners) { sink.add_strip(corners); });
      of_points.push_back(decode(p.of_points, n, 0, "points"));
      const std::size_t faces = (p.poly_offsets ? p.poly_offsets->count() : 0) +  //
                                (p.strip_offsets ? p.strip_offsets->count() : 0);
      if (cells_known && faces > 0) of_faces.push_back(decode(p.of_cells, faces, p.other_cells, "cells"));
    }
    sink.done();
    points.attributes = join_tables(in_, std::move(of_points), "pieces");
    if (cells_known) points.triangle_attributes = join_tables(in_, std::move(of_faces), "pieces").taken(face_of);
    store_positions(in_, points, positions.size(), [&](std::size_t i) { return positions[i]; });
    finish(in_, points);
    return points;
  }

  /// n rows of the arrays after `skipped` rows.
  AttributeTable decode(const std::vector<Array>& arrays, std::size_t n, std::size_t skipped, const char* of) const {
    std::vector<NamedColumns> columns;
    for (const Array& a : arrays) {
      if (skipped > a.count() || a.count() != (n + skipped) * a.components) {
        in_.warn(fmt::format("'{}' has {} numbers for {} {}: left out", printable(a.name, 80), grouped(a.count()),
                             grouped(n + skipped), of));
        continue;
      }
      NamedColumns c = a.columns();
      for (Column& column : c.components) column.at += skipped * column.stride;
      columns.push_back(std::move(c));
    }
    return decode_attributes(in_, columns, n, false);
  }

  template <class Add>
  void add_cells(const std::optional<Array>& connectivity, const std::optional<Array>& offsets, std::size_t first,
                 std::size_t n, Add&& add) const {
    if (!connectivity || !offsets) return;
    std::vector<std::int64_t> corners = connectivity->integers();
    for (std::int64_t& c : corners) {
      if (c < 0 || c >= static_cast<std::int64_t>(n)) {
        in_.fail(fmt::format("a face refers to point {}, but there are only {} points", c, grouped(n)));
      }
      c += static_cast<std::int64_t>(first);
    }
    std::int64_t start = 0;
    for (const std::int64_t stop : offsets->integers()) {
      if (stop < start || stop > static_cast<std::int64_t>(corners.size()))
        in_.fail("malformed VTP: impossible offsets of faces");
      add(std::span(corners).subspan(static_cast<std::size_t>(start), static_cast<std::size_t>(stop - start)));
      start = stop;
    }
  }

  const Input& in_;
  bool swap_ = false, wide_header_ = false, appended_base64_ = false, lines_wanted_ = false;
  std::string_view compressor_, appended_;
  std::uint64_t taken_ = 0;  ///< bytes of all arrays so far
  Piece piece_;
  std::vector<Piece> pieces_;
};

}  // namespace

PolylineSet read_vtp_lines(const Input& in) {
  in.report.format = "VTK XML polydata";
  return VtpReader(in).read_lines();
}

PointSet read_vtp(const Input& in) {
  in.report.format = "VTK XML polydata";
  return VtpReader(in).read();
}

}  // namespace sansmesh::inline v1::io
