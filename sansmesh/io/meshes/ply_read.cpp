// PLY: ascii and binary of both byte orders. The vertex element becomes a table of columns, decoded in parallel. Faces
// and triangle strips become triangles. Other scalar properties become attributes of the vertices, or of the triangles
// of a face. Other elements and lists are skipped.
#include <fmt/core.h>

#include <functional>

#include "sansmesh/core/number_words.h"
#include "sansmesh/io/meshes/face_sink.h"
#include "sansmesh/io/meshes/ply_header.h"
#include "sansmesh/io/points/assemble_points.h"
#include "sansmesh/io/points/columns.h"
#include "sansmesh/io/readers.h"
#include "sansmesh/io/reference_text.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {
namespace {

using Property = PlyProperty;
using Element = PlyElement;

/// The property with one of the names, earlier names first, or npos.
std::size_t find_property(const Element& e, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    for (std::size_t k = 0; k < e.properties.size(); ++k) {
      if (!e.properties[k].is_list && e.properties[k].name == name) return k;
    }
  }
  return std::string::npos;
}

/// The properties that are not `used`, as attributes; column(k): the column of property k.
template <class MakeColumn>
std::vector<NamedColumns> other_columns(const Element& e, const std::vector<std::uint8_t>& used, MakeColumn&& column) {
  std::vector<NamedColumns> others;
  for (std::size_t k = 0; k < e.properties.size(); ++k) {
    const Property& q = e.properties[k];
    if (!q.is_list && !used[k]) others.push_back({q.given, q.type, {column(k)}});
  }
  return others;
}

/// Marks the properties with a known meaning as `used`.
template <class MakeColumn>
CloudColumns name_columns(const Input& in, const Element& e, MakeColumn&& column, std::vector<std::uint8_t>& used) {
  CloudColumns c;
  std::vector<std::size_t> picked;
  const auto pick = [&](Column& target, std::initializer_list<const char*> names) {
    const std::size_t k = find_property(e, names);
    if (k != std::string::npos) target = column(k), picked.push_back(k);
  };
  const auto use_picked = [&](bool complete) {
    for (const std::size_t k : picked) used[k] = complete;
    picked.clear();
  };
  pick(c.position[0], {"x", "posx", "px"}), pick(c.position[1], {"y", "posy", "py"});
  pick(c.position[2], {"z", "posz", "pz"});
  use_picked(true);
  pick(c.normal[0], {"nx", "normal_x", "normalx"}), pick(c.normal[1], {"ny", "normal_y", "normaly"});
  pick(c.normal[2], {"nz", "normal_z", "normalz"});
  use_picked(c.has_normals());
  pick(c.color[0], {"red", "r", "diffuse_red"}), pick(c.color[1], {"green", "g", "diffuse_green"});
  pick(c.color[2], {"blue", "b", "diffuse_blue"});
  use_picked(c.has_colors());
  if (!c.position[0] || !c.position[1] || !c.position[2]) in.fail("the PLY vertices have no x, y and z");
  return c;
}

/// Decodes vertices; column(k): the column of property k, with cells of text if `text`.
template <class MakeColumn>
void decode_vertices(const Input& in, const Element& e, MakeColumn&& column, bool text, PointSet& points) {
  const std::size_t n = static_cast<std::size_t>(e.count);
  std::vector<std::uint8_t> used(e.properties.size(), 0);
  CloudColumns columns = name_columns(in, e, column, used);
  const std::size_t red = find_property(e, {"red", "r", "diffuse_red"});
  columns.whole_colors = text && red != std::string::npos && !is_real(e.properties[red].type);
  decode_columns(in, columns, n, points);
  points.attributes = decode_attributes(in, other_columns(e, used, column), n);
}

/// Reports skipped elements and lists.
void report_skipped(const Input& in, const PlyHeader& header) {
  for (const Element& e : header.elements) {
    if (e.count == 0) continue;
    const bool faces = e.holds_polygons() || e.holds_strips();
    if (e.name != "vertex" && !(faces && e.index_list() != std::string::npos)) {
      in.unread(e.name == "range_grid" ? "rows and columns" : "elements '" + e.name + "'");
      continue;
    }
    for (std::size_t k = 0; k < e.properties.size(); ++k)
      if (e.properties[k].is_list && !(faces && k == e.index_list()))
        in.unread("lists '" + e.properties[k].given + "' of " + e.name);
  }
}

/// Whether faces have scalar properties.
bool has_scalars(const Element& e) {
  return std::any_of(e.properties.begin(), e.properties.end(), [](const Property& q) { return !q.is_list; });
}

/// Attributes of faces.
template <class MakeColumn>
AttributeTable decode_faces(const Input& in, const Element& e, MakeColumn&& column) {
  const std::vector<std::uint8_t> none(e.properties.size(), 0);
  return decode_attributes(in, other_columns(e, none, column), static_cast<std::size_t>(e.count));
}

/// Columns of a table of cells, one row per record.
auto columns_of(const Element& e, const std::vector<double>& table) {
  return [&](std::size_t k) {
    return Column{reinterpret_cast<const char*>(table.data() + k), e.properties.size() * sizeof(double),
                  cell_type(e.properties[k].type), false};
  };
}

/// Fails unless the records of `e`, of at least `least` bytes each, fit into `have` bytes.
void check_room(const Input& in, const Element& e, std::size_t least, std::size_t have, bool exact) {
  if (e.count <= have / least) return;
  const double missing = static_cast<double>(e.count) * static_cast<double>(least) - static_cast<double>(have);
  if (missing > 1e15)
    in.fail(fmt::format("announces {} {} records, far more than its {} bytes hold", e.count, e.name, grouped(have)));
  in.fail_short(e.count * least, have, !exact);
}

/// An index given as a number of any type; -1 if it is not an integer.
template <class T>
std::int64_t to_index(T value) {
  if constexpr (std::is_floating_point_v<T>)
    return value >= 0 && value < T(4294967295.0) ? static_cast<std::int64_t>(value) : -1;
  return static_cast<std::int64_t>(value);
}

// ---------------------------------------------------------------------------------------------------- binary

/// Skips one record of `e` at `p`, calling seen(property, count, address) for each property; null if it exceeds `end`.
template <class Seen>
const char* walk_record(const Element& e, const char* p, const char* end, bool swap, Seen&& seen) {
  for (std::size_t k = 0; k < e.properties.size(); ++k) {
    const Property& q = e.properties[k];
    std::uint64_t count = 1;
    if (q.is_list) {
      const std::size_t s = size_of(q.count_type);
      if (static_cast<std::size_t>(end - p) < s) return nullptr;
      const double n = load_number(p, q.count_type, swap);
      if (n < 0) return nullptr;
      count = static_cast<std::uint64_t>(n);
      p += s;
    }
    const std::size_t room = static_cast<std::size_t>(end - p) / size_of(q.type);
    if (count > room) return nullptr;
    seen(k, count, p);
    p += count * size_of(q.type);
  }
  return p;
}

/// Bytes of the first record if all records have lists of the same lengths as the first, else 0.
std::size_t uniform_record(const Element& e, std::string_view body, bool swap, std::vector<std::size_t>& offsets) {
  const char* const base = body.data();
  const char* const end = base + body.size();
  offsets.assign(e.properties.size(), 0);
  std::vector<std::uint64_t> counts(e.properties.size(), 1);
  const char* const after = walk_record(e, base, end, swap, [&](std::size_t k, std::uint64_t count, const char* p) {
    offsets[k] = static_cast<std::size_t>(p - base);
    counts[k] = count;
  });
  if (!after) return 0;
  const std::size_t stride = static_cast<std::size_t>(after - base);
  if (stride == 0 || e.count > body.size() / stride) return 0;
  // If every count at its assumed position agrees, then by induction every record starts at its assumed position.
  for (std::size_t k = 0; k < e.properties.size(); ++k) {
    const Property& q = e.properties[k];
    if (!q.is_list) continue;
    const bool same = with_loader(q.count_type, swap, [&](auto at) {
      const char* const count_at = base + offsets[k] - size_of(q.count_type);
      using Count = typename decltype(at)::Value;
      const Count wanted = static_cast<Count>(counts[k]);
      const std::size_t others = parallel_reduce(
          static_cast<std::size_t>(e.count), 1 << 16, std::size_t{0},
          [&](std::size_t first, std::size_t last) {
            std::size_t different = 0;
            for (std::size_t i = first; i < last; ++i) different += at(count_at + i * stride) != wanted;
            return different;
          },
          std::plus<>());
      return others == 0;
    });
    if (!same) return 0;
  }
  return stride;
}

/// Reads or skips element `e` at the start of `body`; returns the bytes after it.
std::string_view read_binary_element(const Input& in, const Element& e, std::string_view body, bool swap,
                                     PointSet& points) {
  const bool vertices = e.name == "vertex";
  const std::size_t least = e.least_bytes();
  if (e.count == 0 || least == 0) return body;
  check_room(in, e, least, body.size(), e.fixed());
  const std::size_t n = static_cast<std::size_t>(e.count);
  const std::size_t list = e.index_list();
  const bool faces = e.holds_polygons() && list != std::string::npos;
  const bool strips = e.holds_strips() && list != std::string::npos;
  const bool described = (faces || strips) && points.triangles.empty() && has_scalars(e);

  std::vector<std::size_t> offsets;
  const std::size_t stride = uniform_record(e, body, swap, offsets);
  const auto column = [&](std::size_t k) {
    return Column{body.data() + offsets[k], stride, e.properties[k].type, swap};
  };
  if (stride > 0 && vertices) {
    decode_vertices(in, e, column, false, points);
    return body.substr(stride * n);
  }
  if (stride > 0 && !faces && !strips) return body.substr(stride * n);
  if (stride > 0 && faces && !is_real(e.properties[list].type) && size_of(e.properties[list].type) <= 4) {
    std::size_t next = stride;  // the list ends where the next property begins
    for (std::size_t k = list + 1; k < e.properties.size(); ++k) {
      const Property& q = e.properties[k];
      next = std::min(next, offsets[k] - (q.is_list ? size_of(q.count_type) : 0));
    }
    if ((next - offsets[list]) / size_of(e.properties[list].type) == 3) {
      const std::size_t first_triangle = points.triangles.size();
      points.triangles.resize(first_triangle + n);
      with_loader(e.properties[list].type, swap, [&](auto at) {
        using T = typename decltype(at)::Value;
        parallel_for(0, n, 1 << 14, [&](std::size_t i) {
          const char* p = body.data() + offsets[list] + i * stride;
          points.triangles[first_triangle + i] = {static_cast<std::uint32_t>(at(p)),
                                                  static_cast<std::uint32_t>(at(p + sizeof(T))),
                                                  static_cast<std::uint32_t>(at(p + 2 * sizeof(T)))};
        });
      });
      if (described) points.triangle_attributes = decode_faces(in, e, column);
      return body.substr(stride * n);
    }
  }

  // Records of different lengths are read sequentially.
  const char* p = body.data();
  const char* const end = p + body.size();
  std::vector<std::uint32_t> face_of;
  FaceSink sink(in, points.triangles, described ? &face_of : nullptr);
  std::vector<std::int64_t> corners;
  std::vector<double> table;
  const std::size_t width = e.properties.size();
  if (vertices || described) table.resize(n * width);
  for (std::size_t i = 0; i < n; ++i) {
    p = walk_record(e, p, end, swap, [&](std::size_t k, std::uint64_t count, const char* at) {
      if (!table.empty() && !e.properties[k].is_list) {
        table[i * width + k] = load_cell(at, e.properties[k].type, swap);
      } else if (k == list && (faces || strips)) {
        corners.resize(count);
        with_loader(e.properties[k].type, swap, [&](auto load_one) {
          constexpr std::size_t size = sizeof(typename decltype(load_one)::Value);
          for (std::size_t c = 0; c < count; ++c) corners[c] = to_index(load_one(at + c * size));
        });
      }
    });
    if (!p) {
      in.fail(fmt::format("truncated: ends in {} {} of {}", e.name, grouped(i + 1), grouped(e.count)));
    }
    if (faces) sink.add_polygon(corners);
    if (strips) sink.add_strip(corners);
  }
  sink.done();
  if (vertices) decode_vertices(in, e, columns_of(e, table), true, points);
  if (described) points.triangle_attributes = decode_faces(in, e, columns_of(e, table)).taken(face_of);
  return {p, static_cast<std::size_t>(end - p)};
}

// ----------------------------------------------------------------------------------------------------- ascii

/// Reads the rows of a fixed ascii element as a table, in parallel, if each of the next non-blank lines holds exactly
/// one record; otherwise returns false and leaves `text` unmoved.
bool read_rows(TextScanner& text, const Element& e, std::vector<double>& table) {
  const std::size_t n = static_cast<std::size_t>(e.count), width = e.properties.size();
  const std::string_view all = text.rest();
  const std::size_t chunk = 1 << 13;
  std::vector<const char*> starts;  // beginning of every chunk-th line
  const char* p = all.data();
  const char* const end = p + all.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (p == end) return false;
    if (i % chunk == 0) starts.push_back(p);
    const char* stop = static_cast<const char*>(std::memchr(p, '\n', static_cast<std::size_t>(end - p)));
    p = stop ? stop + 1 : end;
  }
  starts.push_back(p);
  table.resize(n * width);
  std::vector<char> good(starts.size() - 1, 0);
  parallel_for(0, good.size(), 1, [&](std::size_t c) {
    TextScanner lines({starts[c], static_cast<std::size_t>(starts[c + 1] - starts[c])});
    const std::size_t last = std::min(n, (c + 1) * chunk);
    for (std::size_t i = c * chunk; i < last; ++i) {
      TextScanner line(lines.line());
      for (std::size_t k = 0; k < width; ++k) {
        if (!read_cell(line, e.properties[k].type, table[i * width + k])) return;
      }
      line.skip_blanks();
      if (!line.at_end()) return;
    }
    good[c] = 1;
  });
  if (std::find(good.begin(), good.end(), 0) != good.end()) return false;
  text = TextScanner({p, static_cast<std::size_t>(end - p)});
  return true;
}

void read_ascii_element(const Input& in, const Element& e, TextScanner& text, PointSet& points) {
  const bool vertices = e.name == "vertex";
  const std::size_t width = e.properties.size();
  if (e.count == 0 || width == 0) return;
  // Every value takes a digit and a separator, which the last one may lack.
  check_room(in, e, 2 * width, text.rest().size() + 1, false);
  const std::size_t n = static_cast<std::size_t>(e.count);
  const std::size_t list = e.index_list();
  const bool faces = e.holds_polygons() && list != std::string::npos;
  const bool strips = e.holds_strips() && list != std::string::npos;
  const bool described = (faces || strips) && points.triangles.empty() && has_scalars(e);

  std::vector<double> table;
  std::vector<std::uint32_t> face_of;
  const bool by_rows = vertices && e.fixed() && read_rows(text, e, table);
  if (!by_rows) {
    if (vertices || described) table.resize(n * width);
    FaceSink sink(in, points.triangles, described ? &face_of : nullptr);
    std::vector<std::int64_t> corners;
    const auto complain = [&](std::size_t i) {
      if (text.at_end()) {
        in.fail(fmt::format("truncated: ends in {} {} of {}", e.name, grouped(i + 1), grouped(e.count)));
      }
      const std::string_view word = text.word();
      in.fail(fmt::format("malformed PLY: '{}' in {} {} is not a number", word.substr(0, 40), e.name, grouped(i + 1)));
    };
    const auto next = [&](auto& value, std::size_t i) {
      text.skip_space();
      if (!text.number(value)) complain(i);
    };
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 0; k < width; ++k) {
        const Property& q = e.properties[k];
        double value = 0;
        if (!q.is_list) {
          text.skip_space();
          if (!read_cell(text, q.type, value)) complain(i);
          if (!table.empty()) table[i * width + k] = value;
          continue;
        }
        std::int64_t count = 0;
        next(count, i);
        if (count < 0 || static_cast<std::uint64_t>(count) > text.rest().size()) {
          in.fail(fmt::format("truncated or malformed: {} {} announces a list of {} values", e.name, grouped(i + 1),
                              count));
        }
        const bool keep = k == list && (faces || strips);
        if (keep) corners.resize(static_cast<std::size_t>(count));
        for (std::int64_t c = 0; c < count; ++c) {
          if (keep && !is_real(q.type)) {
            next(corners[static_cast<std::size_t>(c)], i);
          } else {
            next(value, i);
            if (keep) corners[static_cast<std::size_t>(c)] = to_index(value);
          }
        }
      }
      if (faces) sink.add_polygon(corners);
      if (strips) sink.add_strip(corners);
    }
    sink.done();
  }
  if (vertices) decode_vertices(in, e, columns_of(e, table), true, points);
  if (described) points.triangle_attributes = decode_faces(in, e, columns_of(e, table)).taken(face_of);
}

}  // namespace

PointSet read_ply(const Input& in) {
  const PlyHeader header = parse_ply_header(in);
  in.report.format = header.encoding == PlyEncoding::ascii    ? "PLY ascii"
                     : header.encoding == PlyEncoding::little ? "PLY binary little endian"
                                                              : "PLY binary big endian";
  const auto vertex =
      std::find_if(header.elements.begin(), header.elements.end(), [](const Element& e) { return e.name == "vertex"; });
  if (vertex == header.elements.end() || vertex->count == 0) in.fail("holds no points");
  if (std::any_of(vertex + 1, header.elements.end(), [](const Element& e) { return e.name == "vertex"; })) {
    in.fail("malformed PLY header: more than one vertex element");
  }

  PointSet points;
  if (header.encoding == PlyEncoding::ascii) {
    TextScanner text(header.body);
    for (const Element& e : header.elements) read_ascii_element(in, e, text, points);
  } else {
    std::string_view body = header.body;
    for (const Element& e : header.elements) {
      body = read_binary_element(in, e, body, header.encoding == PlyEncoding::big, points);
    }
  }
  const bool range_image = std::any_of(header.elements.begin(), header.elements.end(),
                                       [](const Element& e) { return e.name == "range_grid"; });
  if (range_image) set_scanner(points, {0, 0, 1});
  for (const Attribute& a : points.triangle_attributes) {
    if (a.rows() == points.triangles.size()) continue;  // else the faces are of several elements
    in.warn("attributes of faces are read where one element holds all faces: they were left out");
    points.triangle_attributes.clear();
    break;
  }
  report_skipped(in, header);
  finish(in, points);
  points.reference = system_of_ply(in.bytes);
  return points;
}

}  // namespace sansmesh::inline v1::io
