// PLY: ascii and binary of both byte orders. The vertex element becomes a table of columns, decoded in parallel; faces
// and triangle strips become triangles; every other element is stepped over.
#include <fmt/core.h>

#include <functional>

#include "sansmesh/io/columns.h"
#include "sansmesh/io/face_sink.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::io {
namespace {

struct Property {
  std::string name;
  NumberType type = NumberType::f32;
  bool is_list = false;
  NumberType count_type = NumberType::u8;
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;

  bool fixed() const {
    return std::none_of(properties.begin(), properties.end(), [](const Property& p) { return p.is_list; });
  }
  /// Bytes of one record whose lists are all empty.
  std::size_t least_bytes() const {
    std::size_t s = 0;
    for (const Property& p : properties) s += size_of(p.is_list ? p.count_type : p.type);
    return s;
  }
  bool holds_polygons() const { return name == "face" || name == "faces" || name == "polygon"; }
  bool holds_strips() const { return name == "tristrips" || name == "tristrip"; }
  /// The list of vertex indices, or npos.
  std::size_t index_list() const {
    for (std::size_t k = 0; k < properties.size(); ++k) {
      const Property& p = properties[k];
      if (p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index")) return k;
    }
    return std::string::npos;
  }
};

enum class Encoding { ascii, little, big };

struct Header {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
  std::string_view body;
};

NumberType parse_type(const Input& in, std::string_view word) {
  const std::string w = lower(word);
  if (w == "char" || w == "int8") return NumberType::i8;
  if (w == "uchar" || w == "uint8") return NumberType::u8;
  if (w == "short" || w == "int16") return NumberType::i16;
  if (w == "ushort" || w == "uint16") return NumberType::u16;
  if (w == "int" || w == "int32") return NumberType::i32;
  if (w == "uint" || w == "uint32") return NumberType::u32;
  if (w == "int64" || w == "longlong") return NumberType::i64;
  if (w == "uint64" || w == "ulonglong") return NumberType::u64;
  if (w == "float" || w == "float32") return NumberType::f32;
  if (w == "double" || w == "float64") return NumberType::f64;
  in.fail(fmt::format("malformed PLY header: unknown property type '{}'", word.substr(0, 40)));
}

Header parse_header(const Input& in) {
  Header header;
  TextScanner text(in.bytes);
  if (text.line() != "ply") in.fail("is not a PLY file (does not begin with 'ply')");
  bool have_format = false;
  for (;;) {
    if (text.at_end()) in.fail("truncated: the PLY header has no 'end_header'");
    const std::string_view line = text.line();
    if (line.size() > 4096) in.fail("malformed PLY header: a line of more than 4,096 characters");
    TextScanner words(line);
    const std::string_view key = words.word();
    if (key == "end_header") break;
    if (key.empty() || key == "comment" || key == "obj_info") continue;
    if (key == "format") {
      const std::string_view w = words.word();
      have_format = true;
      if (w == "ascii")
        header.encoding = Encoding::ascii;
      else if (w == "binary_little_endian")
        header.encoding = Encoding::little;
      else if (w == "binary_big_endian")
        header.encoding = Encoding::big;
      else
        in.fail(fmt::format("malformed PLY header: unknown format '{}'", w.substr(0, 40)));
    } else if (key == "element") {
      Element element;
      element.name = lower(words.word());
      if (element.name.empty() || !words.number(element.count)) {
        in.fail(fmt::format("malformed PLY header: '{}'", line.substr(0, 80)));
      }
      header.elements.push_back(std::move(element));
    } else if (key == "property") {
      if (header.elements.empty()) in.fail("malformed PLY header: a property before any element");
      Property property;
      std::string_view type = words.word();
      if (type == "list") {
        property.is_list = true;
        property.count_type = parse_type(in, words.word());
        if (is_real(property.count_type)) in.fail("malformed PLY header: a list's length must be an integer");
        type = words.word();
      }
      property.type = parse_type(in, type);
      property.name = lower(words.word());
      if (property.name.empty()) in.fail(fmt::format("malformed PLY header: '{}'", line.substr(0, 80)));
      header.elements.back().properties.push_back(std::move(property));
    } else {
      in.fail(fmt::format("malformed PLY header: unknown keyword '{}'", key.substr(0, 40)));
    }
  }
  if (!have_format) in.fail("malformed PLY header: no 'format' line");
  header.body = text.rest();
  return header;
}

/// The column of the vertex element that holds property `name`; `record` is the first record's address.
std::size_t find_property(const Element& e, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    for (std::size_t k = 0; k < e.properties.size(); ++k) {
      if (!e.properties[k].is_list && e.properties[k].name == name) return k;
    }
  }
  return std::string::npos;
}

/// column(k): the column of property k.
template <class MakeColumn>
CloudColumns name_columns(const Input& in, const Element& e, MakeColumn&& column) {
  CloudColumns c;
  const auto pick = [&](Column& target, std::initializer_list<const char*> names) {
    const std::size_t k = find_property(e, names);
    if (k != std::string::npos) target = column(k);
  };
  pick(c.position[0], {"x", "posx", "px"}), pick(c.position[1], {"y", "posy", "py"});
  pick(c.position[2], {"z", "posz", "pz"});
  pick(c.normal[0], {"nx", "normal_x", "normalx"}), pick(c.normal[1], {"ny", "normal_y", "normaly"});
  pick(c.normal[2], {"nz", "normal_z", "normalz"});
  pick(c.color[0], {"red", "r", "diffuse_red"}), pick(c.color[1], {"green", "g", "diffuse_green"});
  pick(c.color[2], {"blue", "b", "diffuse_blue"});
  pick(c.confidence, {"confidence", "quality", "scalar_confidence", "scalar_quality"});
  if (!c.position[0] || !c.position[1] || !c.position[2]) in.fail("the PLY vertices have no x, y and z");
  return c;
}

// ---------------------------------------------------------------------------------------------------- binary

/// Steps over one record of `e` at `p`, calling seen(property, count, address) for each; null if it leaves `end`.
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
  // If every count at its assumed place agrees, then by induction every record starts where assumed.
  for (std::size_t k = 0; k < e.properties.size(); ++k) {
    const Property& q = e.properties[k];
    if (!q.is_list) continue;
    const bool same = with_loader(q.count_type, swap, [&](auto at) {
      const char* const place = base + offsets[k] - size_of(q.count_type);
      using Count = typename decltype(at)::Value;
      const Count wanted = static_cast<Count>(counts[k]);
      const std::size_t others = parallel_reduce(
          static_cast<std::size_t>(e.count), 1 << 16, std::size_t{0},
          [&](std::size_t first, std::size_t last) {
            std::size_t different = 0;
            for (std::size_t i = first; i < last; ++i) different += at(place + i * stride) != wanted;
            return different;
          },
          std::plus<>());
      return others == 0;
    });
    if (!same) return 0;
  }
  return stride;
}

/// Reads or steps over element `e` at the start of `body`; returns what follows it.
std::string_view read_binary_element(const Input& in, const Element& e, std::string_view body, bool swap,
                                     PointSet& points) {
  const bool vertices = e.name == "vertex";
  const std::size_t least = e.least_bytes();
  if (e.count == 0 || least == 0) return body;
  if (e.count > body.size() / least) {
    const double missing = static_cast<double>(e.count) * static_cast<double>(least) - static_cast<double>(body.size());
    if (missing > 1e15) in.fail(fmt::format("announces {} {} records, far more than the file holds", e.count, e.name));
    in.fail_truncated(static_cast<std::uint64_t>(missing), !e.fixed());
  }
  const std::size_t n = static_cast<std::size_t>(e.count);
  const std::size_t list = e.index_list();
  const bool faces = e.holds_polygons() && list != std::string::npos;
  const bool strips = e.holds_strips() && list != std::string::npos;

  std::vector<std::size_t> offsets;
  const std::size_t stride = uniform_record(e, body, swap, offsets);
  const auto column = [&](std::size_t k) {
    return Column{body.data() + offsets[k], stride, e.properties[k].type, swap};
  };
  if (stride > 0 && vertices) {
    decode_columns(name_columns(in, e, column), n, points);
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
      return body.substr(stride * n);
    }
  }

  // Records of different lengths: one after the other.
  const char* p = body.data();
  const char* const end = p + body.size();
  FaceSink sink(in, points.triangles);
  std::vector<std::int64_t> corners;
  std::vector<double> table;
  const std::size_t width = e.properties.size();
  if (vertices) table.resize(n * width);
  for (std::size_t i = 0; i < n; ++i) {
    p = walk_record(e, p, end, swap, [&](std::size_t k, std::uint64_t count, const char* at) {
      if (vertices && !e.properties[k].is_list) {
        table[i * width + k] = load_number(at, e.properties[k].type, swap);
      } else if (k == list && (faces || strips)) {
        corners.resize(count);
        with_loader(e.properties[k].type, swap, [&](auto load_one) {
          constexpr std::size_t size = sizeof(typename decltype(load_one)::Value);
          for (std::size_t c = 0; c < count; ++c) corners[c] = static_cast<std::int64_t>(load_one(at + c * size));
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
  if (vertices) {
    const auto cell = [&](std::size_t k) {
      return Column{reinterpret_cast<const char*>(table.data() + k), width * sizeof(double), NumberType::f64, false};
    };
    CloudColumns columns = name_columns(in, e, cell);
    const std::size_t red = find_property(e, {"red", "r", "diffuse_red"});
    columns.whole_colors = red != std::string::npos && !is_real(e.properties[red].type);
    decode_columns(columns, n, points);
  }
  return {p, static_cast<std::size_t>(end - p)};
}

// ----------------------------------------------------------------------------------------------------- ascii

/// The rows of a fixed ascii element as a table, read in parallel, if every one of the next lines that is not blank
/// holds exactly one record; nothing (and `text` unmoved) otherwise.
bool read_rows(TextScanner& text, std::size_t n, std::size_t width, std::vector<double>& table) {
  const std::string_view all = text.rest();
  const std::size_t chunk = 1 << 13;
  std::vector<const char*> starts;  // of every chunk-th line
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
        if (!line.number(table[i * width + k])) return;
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
  // Every value takes a digit and a separator.
  const std::size_t room = (text.rest().size() + 1) / 2;
  if (e.count > room / width) {
    const double missing =
        2.0 * static_cast<double>(e.count) * static_cast<double>(width) - static_cast<double>(text.rest().size()) - 1;
    if (missing > 1e15) in.fail(fmt::format("announces {} {} records, far more than the file holds", e.count, e.name));
    in.fail_truncated(static_cast<std::uint64_t>(missing), true);
  }
  const std::size_t n = static_cast<std::size_t>(e.count);
  const std::size_t list = e.index_list();
  const bool faces = e.holds_polygons() && list != std::string::npos;
  const bool strips = e.holds_strips() && list != std::string::npos;

  std::vector<double> table;
  const bool by_rows = vertices && e.fixed() && read_rows(text, n, width, table);
  if (!by_rows) {
    if (vertices) table.resize(n * width);
    FaceSink sink(in, points.triangles);
    std::vector<std::int64_t> corners;
    const auto next = [&](auto& value, std::size_t i) {
      text.skip_space();
      if (text.number(value)) return;
      if (text.at_end()) {
        in.fail(fmt::format("truncated: ends in {} {} of {}", e.name, grouped(i + 1), grouped(e.count)));
      }
      const std::string_view word = text.word();
      in.fail(fmt::format("malformed PLY: '{}' in {} {} is not a number", word.substr(0, 40), e.name, grouped(i + 1)));
    };
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t k = 0; k < width; ++k) {
        const Property& q = e.properties[k];
        double value = 0;
        if (!q.is_list) {
          next(value, i);
          if (vertices) table[i * width + k] = value;
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
            if (keep) corners[static_cast<std::size_t>(c)] = static_cast<std::int64_t>(value);
          }
        }
      }
      if (faces) sink.add_polygon(corners);
      if (strips) sink.add_strip(corners);
    }
    sink.done();
  }
  if (vertices) {
    const auto cell = [&](std::size_t k) {
      return Column{reinterpret_cast<const char*>(table.data() + k), width * sizeof(double), NumberType::f64, false};
    };
    CloudColumns columns = name_columns(in, e, cell);
    const std::size_t red = find_property(e, {"red", "r", "diffuse_red"});
    columns.whole_colors = red != std::string::npos && !is_real(e.properties[red].type);
    decode_columns(columns, n, points);
  }
}

}  // namespace

PointSet read_ply(const Input& in) {
  const Header header = parse_header(in);
  in.report.format = header.encoding == Encoding::ascii    ? "PLY ascii"
                     : header.encoding == Encoding::little ? "PLY binary little endian"
                                                           : "PLY binary big endian";
  const auto vertex =
      std::find_if(header.elements.begin(), header.elements.end(), [](const Element& e) { return e.name == "vertex"; });
  if (vertex == header.elements.end() || vertex->count == 0) in.fail("holds no points");
  if (std::any_of(vertex + 1, header.elements.end(), [](const Element& e) { return e.name == "vertex"; })) {
    in.fail("malformed PLY header: more than one vertex element");
  }

  PointSet points;
  if (header.encoding == Encoding::ascii) {
    TextScanner text(header.body);
    for (const Element& e : header.elements) read_ascii_element(in, e, text, points);
  } else {
    std::string_view body = header.body;
    for (const Element& e : header.elements) {
      body = read_binary_element(in, e, body, header.encoding == Encoding::big, points);
    }
  }
  const bool range_image = std::any_of(header.elements.begin(), header.elements.end(),
                                       [](const Element& e) { return e.name == "range_grid"; });
  if (range_image) set_scanner(points, {0, 0, 1});
  finish(in, points);
  return points;
}

}  // namespace sansmesh::io
