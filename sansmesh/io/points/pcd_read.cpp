// PCD (Point Cloud Library): ascii, binary and binary_compressed.
#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "sansmesh/core/number_words.h"
#include "sansmesh/core/option_text.h"
#include "sansmesh/io/points/assemble_points.h"
#include "sansmesh/io/points/columns.h"
#include "sansmesh/io/points/frame_view.h"
#include "sansmesh/io/points/lzf.h"
#include "sansmesh/io/readers.h"
#include "sansmesh/io/text_scanner.h"

namespace sansmesh::inline v1::io {
namespace {

struct Field {
  std::string name;   ///< in lower case
  std::string given;  ///< as in the file
  std::size_t size = 4;
  char kind = 'F';
  std::size_t count = 1;
  std::size_t offset = 0;  ///< in a record, bytes
  std::size_t first = 0;   ///< in a row of text, words

  std::optional<NumberType> known_type() const {
    if (kind == 'F' && size == 4) return NumberType::f32;
    if (kind == 'F' && size == 8) return NumberType::f64;
    if (kind == 'U' || kind == 'I') {
      const bool is_signed = kind == 'I';
      switch (size) {
        case 1:
          return is_signed ? NumberType::i8 : NumberType::u8;
        case 2:
          return is_signed ? NumberType::i16 : NumberType::u16;
        case 4:
          return is_signed ? NumberType::i32 : NumberType::u32;
        case 8:
          return is_signed ? NumberType::i64 : NumberType::u64;
        default:
          break;
      }
    }
    return std::nullopt;
  }
  NumberType type(const Input& in) const {
    if (const auto known = known_type()) return *known;
    in.fail(fmt::format("malformed PCD header: field '{}' has type {} of {} bytes", name, kind, size));
  }
};

struct PcdHeader {
  std::vector<Field> fields;
  std::uint64_t width = 0, height = 1, points = 0;
  bool has_points = false;
  double viewpoint[3] = {0, 0, 0};
  std::string data;
  std::string_view body;
  std::size_t record = 0;
  std::size_t words = 0;

  const Field* find(std::initializer_list<const char*> names) const {
    for (const char* name : names) {
      for (const Field& f : fields) {
        if (f.name == name) return &f;
      }
    }
    return nullptr;
  }
};

PcdHeader parse_header(const Input& in) {
  PcdHeader h;
  TextScanner text(in.bytes);
  bool seen_version = false;
  while (h.data.empty()) {
    if (text.at_end()) in.fail(seen_version ? "truncated: the PCD header has no DATA line" : "is not a PCD file");
    const std::string_view line = text.line();
    TextScanner words(line);
    const std::string_view key = words.word();
    if (key.empty() || key.front() == '#') continue;
    const auto bad = [&] { in.fail(fmt::format("malformed PCD header: '{}'", line.substr(0, 80))); };
    const auto each = [&](auto&& set) {
      for (Field& f : h.fields) {
        if (!set(f)) bad();
      }
    };
    if (key == "VERSION") {
      seen_version = true;
    } else if (key == "FIELDS" || key == "COLUMNS") {
      for (std::string_view w = words.word(); !w.empty(); w = words.word()) {
        Field& f = h.fields.emplace_back();
        f.given = std::string(w);
        f.name = lower_case(w);
        if (h.fields.size() > 1000) in.fail("malformed PCD header: more than 1,000 fields");
      }
    } else if (key == "SIZE") {
      each([&](Field& f) { return words.number(f.size) && f.size >= 1 && f.size <= 8; });
    } else if (key == "TYPE") {
      each([&](Field& f) {
        const std::string_view w = words.word();
        if (!w.empty()) f.kind = w.front();
        return w.size() == 1;
      });
    } else if (key == "COUNT") {
      each([&](Field& f) { return words.number(f.count) && f.count >= 1 && f.count <= 100000; });
    } else if (key == "WIDTH") {
      if (!words.number(h.width)) bad();
    } else if (key == "HEIGHT") {
      if (!words.number(h.height)) bad();
    } else if (key == "VIEWPOINT") {
      for (double& v : h.viewpoint) {
        if (!words.number(v)) bad();
      }
    } else if (key == "POINTS") {
      if (!words.number(h.points)) bad();
      h.has_points = true;
    } else if (key == "DATA") {
      h.data = lower_case(words.word());
      if (h.data.empty()) bad();
    } else {
      if (!seen_version && h.fields.empty()) in.fail("is not a PCD file");
      bad();
    }
  }
  h.body = text.rest();
  if (!h.has_points) {
    if (h.height != 0 && h.width > (std::uint64_t{1} << 40) / h.height) in.fail("malformed PCD header: absurd size");
    h.points = h.width * h.height;
  }
  for (Field& f : h.fields) {
    f.offset = h.record, f.first = h.words;
    h.record += f.size * f.count, h.words += f.count;
  }
  if (h.points == 0) in.fail("holds no points");
  if (!h.find({"x"}) || !h.find({"y"}) || !h.find({"z"})) in.fail("the PCD fields lack x, y or z");
  return h;
}

void refuse_too_many(const Input& in, const PcdHeader& h, std::uint64_t bytes_each, std::size_t have) {
  if (h.points <= have / bytes_each) return;
  if (h.points > (std::uint64_t{1} << 40)) in.fail(fmt::format("malformed PCD header: announces {} points", h.points));
  in.fail_short(h.points * bytes_each, have, h.data == "ascii");
}

/// Packed colours: red, green and blue in bits 16-23, 8-15 and 0-7.
template <class At>
void unpack_colors(PointSet& points, std::size_t n, At&& at) {
  points.colors.resize(n);
  parallel_for(0, n, 1 << 14, [&](std::size_t i) {
    const std::uint32_t c = at(i);
    points.colors[i] = {static_cast<std::uint8_t>(c >> 16), static_cast<std::uint8_t>(c >> 8),
                        static_cast<std::uint8_t>(c)};
  });
}

/// Decodes positions, normals, colours and attributes; column(field) returns the Column of its first number. `text`:
/// the columns hold cells.
template <class MakeColumn>
void decode_fields(const Input& in, const PcdHeader& h, bool text, PointSet& points, MakeColumn&& column) {
  const std::size_t n = static_cast<std::size_t>(h.points);
  CloudColumns c;
  std::vector<const Field*> used, picked;
  const auto pick = [&](Column& target, std::initializer_list<const char*> names) {
    if (const Field* f = h.find(names)) target = column(*f), picked.push_back(f);
  };
  const auto use_picked = [&](bool complete) {
    if (complete) used.insert(used.end(), picked.begin(), picked.end());
    picked.clear();
  };
  pick(c.position[0], {"x"}), pick(c.position[1], {"y"}), pick(c.position[2], {"z"});
  use_picked(true);
  pick(c.normal[0], {"normal_x", "nx"}), pick(c.normal[1], {"normal_y", "ny"}), pick(c.normal[2], {"normal_z", "nz"});
  use_picked(c.has_normals());
  pick(c.color[0], {"r", "red"}), pick(c.color[1], {"g", "green"}), pick(c.color[2], {"b", "blue"});
  use_picked(c.has_colors());
  const Field* const red = h.find({"r", "red"});
  c.whole_colors = text && red && red->kind != 'F';
  decode_columns(in, c, n, points);

  std::vector<NamedColumns> others;
  const Field* const rgb = h.find({"rgb", "rgba"});
  for (const Field& f : h.fields) {
    const auto type = f.known_type();
    // "_" is padding. Fields with more numbers per point are histograms and descriptors.
    if (!type || &f == rgb || f.name == "_" || f.count > 64 || std::find(used.begin(), used.end(), &f) != used.end())
      continue;
    NamedColumns named{f.given, *type, {}};
    const Column first = column(f);
    for (std::size_t k = 0; k < f.count; ++k) {
      named.components.push_back(first);
      named.components.back().at += k * (text ? sizeof(double) : f.size);
    }
    others.push_back(std::move(named));
  }
  points.attributes = decode_attributes(in, others, n);
}

void read_records(const Input& in, const PcdHeader& h, PointSet& points) {
  const std::size_t n = static_cast<std::size_t>(h.points);
  std::vector<char> unpacked;
  const char* base = h.body.data();
  const bool by_field = h.data == "binary_compressed";
  if (by_field) {
    if (h.body.size() < 8) in.fail_truncated(8 - h.body.size(), true);
    const std::size_t packed = load<std::uint32_t>(base), size = load<std::uint32_t>(base + 4);
    if (packed > h.body.size() - 8) in.fail_short(packed, h.body.size() - 8);
    // No stream of LZF expands further than 264 bytes from 3.
    if (size / 88 > packed) in.fail("damaged compressed data (announces more than it can hold)");
    refuse_too_many(in, h, h.record, size);
    unpacked.resize(size);
    if (!lzf_decompress(h.body.substr(8, packed), unpacked)) in.fail("damaged compressed data");
    base = unpacked.data();
  } else {
    refuse_too_many(in, h, h.record, h.body.size());
  }
  // Compressed data hold one field after the other, plain data one record after the other.
  const auto column = [&](const Field& f) {
    return by_field ? Column{base + f.offset * n, f.size * f.count, f.type(in), false}
                    : Column{base + f.offset, h.record, f.type(in), false};
  };
  decode_fields(in, h, false, points, column);
  if (const Field* rgb = h.find({"rgb", "rgba"}); rgb && rgb->size == 4) {
    const Column c = column(*rgb);
    unpack_colors(points, n, [&](std::size_t i) { return load<std::uint32_t>(c.at + i * c.stride); });
  }
}

void read_rows(const Input& in, const PcdHeader& h, PointSet& points) {
  refuse_too_many(in, h, 2 * h.words, h.body.size() + 1);
  const std::size_t n = static_cast<std::size_t>(h.points);
  const Field* const rgb = h.find({"rgb", "rgba"});
  std::vector<double> table(n * h.words);
  std::vector<std::uint32_t> packed(rgb ? n : 0);
  std::vector<NumberType> types;  // type of each word
  for (const Field& f : h.fields) types.insert(types.end(), f.count, f.known_type().value_or(NumberType::f64));
  TextScanner text(h.body);
  for (std::size_t i = 0; i < n; ++i) {
    text.skip_space();
    if (text.at_end()) in.fail(fmt::format("truncated: holds {} of {} points", grouped(i), grouped(h.points)));
    TextScanner row(text.line());
    for (std::size_t k = 0; k < h.words; ++k) {
      const std::string_view word = row.word();
      TextScanner number(word);
      if (!read_cell(number, types[k], table[i * h.words + k]) || !number.at_end()) {
        if (word.empty())
          in.fail(fmt::format("truncated or malformed: point {} has {} of {} values", grouped(i + 1), k, h.words));
        in.fail(fmt::format("malformed PCD: '{}' in point {} is not a number", word.substr(0, 40), grouped(i + 1)));
      }
      if (rgb && k == rgb->first) {
        // Text shows the packed colour as an integer, or as the float with its bits.
        const double value = cell_number(table[i * h.words + k], types[k]);
        const bool whole = rgb->kind != 'F' || word.find_first_not_of("0123456789") == std::string_view::npos;
        packed[i] = whole ? static_cast<std::uint32_t>(value >= 0 ? std::min(value, 4294967295.0) : 0.0)
                          : std::bit_cast<std::uint32_t>(static_cast<float>(value));
      }
    }
  }
  const auto column = [&](const Field& f) {
    return Column{reinterpret_cast<const char*>(table.data() + f.first), h.words * sizeof(double),
                  cell_type(f.known_type().value_or(NumberType::f64)), false};
  };
  decode_fields(in, h, true, points, column);
  if (rgb) unpack_colors(points, n, [&](std::size_t i) { return packed[i]; });
}

/// An organised cloud is one frame of a camera at the viewpoint. For other clouds the viewpoint is known only if it is
/// not the default of all headers.
void find_viewer(const Input& in, const PcdHeader& h, PointSet& points) {
  const Vec3 eye{h.viewpoint[0], h.viewpoint[1], h.viewpoint[2]};
  bool known = is_finite(Vec3f(eye - points.origin));
  const bool organised = h.height > 1 && h.width > 1 && points.size() / h.height == h.width;
  std::optional<FrameView> view;
  if (organised) {
    const auto position = known ? std::optional<Vec3f>(Vec3f(eye - points.origin)) : std::nullopt;
    view = measure_frame(points.positions, static_cast<std::size_t>(h.width), position);
  }
  if (view) {
    if (known && !view->seen_from_eye) {
      known = false;
      in.warn("its rows and columns were not seen from its viewpoint, which was left out");
    }
    points.grid_normals = std::move(view->normals);
  } else if (eye == Vec3{}) {
    known = false;
  }
  if (!known) return;
  points.scanners.assign(1, Vec3f(eye - points.origin));
  points.scan_of_point.assign(points.size(), 0);
}

}  // namespace

PointSet read_pcd(const Input& in) {
  const PcdHeader h = parse_header(in);
  in.report.format = "PCD " + h.data;
  PointSet points;
  if (h.data == "ascii")
    read_rows(in, h, points);
  else if (h.data == "binary" || h.data == "binary_compressed")
    read_records(in, h, points);
  else
    in.fail(fmt::format("malformed PCD header: unknown kind of data '{}'", h.data.substr(0, 40)));
  find_viewer(in, h, points);
  if (h.height > 1) in.unread("rows and columns");
  if (h.viewpoint[0] != 0 || h.viewpoint[1] != 0 || h.viewpoint[2] != 0) in.unread("the viewpoint");
  finish(in, points);
  return points;
}

}  // namespace sansmesh::inline v1::io
