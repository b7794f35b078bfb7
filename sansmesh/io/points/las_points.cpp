#include "sansmesh/io/points/las_points.h"

#include <fmt/core.h>

#include <algorithm>

#include "sansmesh/core/number_words.h"
#include "sansmesh/io/points/assemble_points.h"
#include "sansmesh/io/points/columns.h"

namespace sansmesh::inline v1::io {
namespace {

/// Records of points: formats 0 to 5 share one layout, 6 to 10 another.
struct LasRecords {
  const char* first;
  std::size_t stride, count;
  unsigned format;
  bool first_version;  ///< LAS 1.0

  bool wide() const { return format >= 6; }
  template <class T>
  T at(std::size_t i, std::size_t offset) const {
    return load<T>(first + i * stride + offset);
  }
  std::uint8_t byte(std::size_t i, std::size_t offset) const { return at<std::uint8_t>(i, offset); }
  /// Synthetic, key point, withheld, overlap: from bit 0 on. Formats 0 to 5 have no overlap bit but a class for it.
  std::uint8_t flags(std::size_t i) const {
    return static_cast<std::uint8_t>(wide() ? byte(i, 15) & 15 : byte(i, 15) >> 5);
  }
};
constexpr unsigned kSynthetic = 1, kWithheld = 4, kOverlap = 8;

/// Adds get(i) of each record unless all are zero: many writers leave most of a record empty.
template <class T, class Get>
void add_unless_zero(AttributeTable& table, const char* name, std::size_t n, Get&& get) {
  std::vector<T> values(n);
  parallel_for(0, n, 1 << 15, [&](std::size_t i) { values[i] = get(i); });
  if (std::any_of(values.begin(), values.end(), [](T v) { return v != T(0); })) table.set(name, std::move(values));
}

/// Attributes of the records as documented in io.h.
AttributeTable las_attributes(const LasRecords& r) {
  using u8 = std::uint8_t;
  using u16 = std::uint16_t;
  const std::size_t n = r.count;
  const bool wide = r.wide();
  const auto bits = [&](std::size_t offset, unsigned shift, unsigned mask) {
    return [&r, offset, shift, mask](std::size_t i) { return static_cast<u8>(r.byte(i, offset) >> shift & mask); };
  };
  const auto flag = [&](unsigned which) {
    return [&r, which](std::size_t i) { return static_cast<u8>((r.flags(i) & which) != 0); };
  };
  AttributeTable table;
  add_unless_zero<u16>(table, "intensity", n, [&](std::size_t i) { return r.at<u16>(i, 12); });
  add_unless_zero<u8>(table, "return_number", n, wide ? bits(14, 0, 15) : bits(14, 0, 7));
  add_unless_zero<u8>(table, "number_of_returns", n, wide ? bits(14, 4, 15) : bits(14, 3, 7));
  add_unless_zero<u8>(table, "classification", n, wide ? bits(16, 0, 255) : bits(15, 0, 31));
  add_unless_zero<u8>(table, "synthetic", n, flag(kSynthetic));
  if (wide) add_unless_zero<u8>(table, "overlap", n, flag(kOverlap));
  if (wide)
    add_unless_zero<float>(table, "scan_angle", n,
                           [&](std::size_t i) { return static_cast<float>(0.006 * r.at<std::int16_t>(i, 18)); });
  else
    add_unless_zero<float>(table, "scan_angle", n,
                           [&](std::size_t i) { return static_cast<float>(r.at<std::int8_t>(i, 16)); });
  // LAS 1.0 had a "file marker", the number of a flight line in a merged file, followed by two bytes for users.
  if (r.first_version)
    add_unless_zero<u16>(table, "point_source_id", n, [&](std::size_t i) { return u16{r.byte(i, 17)}; });
  else
    add_unless_zero<u16>(table, "point_source_id", n, [&](std::size_t i) { return r.at<u16>(i, wide ? 20 : 18); });
  if (!r.first_version) add_unless_zero<u8>(table, "user_data", n, bits(17, 0, 255));
  if (wide || r.format == 1 || r.format >= 3)
    add_unless_zero<double>(table, "gps_time", n, [&](std::size_t i) { return r.at<double>(i, wide ? 22 : 20); });
  if (r.format == 8 || r.format == 10)
    add_unless_zero<u16>(table, "near_infrared", n, [&](std::size_t i) { return r.at<u16>(i, 36); });
  return table;
}

/// Numbers after those of the point format in each record.
struct LasExtra {
  NamedColumns columns;       ///< columns of the first record
  std::vector<Vec3> scaling;  ///< (scale, offset) per component; empty if the numbers are unscaled
};

/// Descriptions of the bytes from `first` on in each record of points, from the records of user "LASF_Spec" and number
/// 4: 192 bytes each (LAS 1.4, "extra bytes"; writers of older versions have adopted them).
std::vector<LasExtra> find_extras(const Input& in, const LasHeader& header, const LasRecords& r, std::size_t first) {
  constexpr std::size_t kDescription = 192;
  constexpr unsigned kScale = 8, kOffset = 16;
  constexpr NumberType types[] = {NumberType::u8,  NumberType::i8,  NumberType::u16, NumberType::i16, NumberType::u32,
                                  NumberType::i32, NumberType::u64, NumberType::i64, NumberType::f32, NumberType::f64};
  std::vector<LasExtra> extras;
  for (const LasVlr& vlr : header.vlrs) {
    if (vlr.id != 4 || vlr.user != "LASF_Spec") continue;
    for (std::size_t at = 0; at + kDescription <= vlr.payload.size(); at += kDescription) {
      const char* const d = vlr.payload.data() + at;
      const unsigned type = load<std::uint8_t>(d + 2), options = load<std::uint8_t>(d + 3);
      if (type == 0) {  // undocumented bytes
        first += options;
        continue;
      }
      if (type > 30) return extras;
      const std::string_view name(d + 4, 32);
      LasExtra extra;
      extra.columns.name = std::string(name.substr(0, name.find('\0')));
      extra.columns.type = types[(type - 1) % 10];
      const std::size_t components = 1 + (type - 1) / 10, bytes = size_of(extra.columns.type);
      if (first + components * bytes > r.stride) {
        in.warn("describes more numbers than fit into its point records: they were left out");
        return extras;
      }
      for (std::size_t k = 0; k < components; ++k, first += bytes) {
        extra.columns.components.push_back({r.first + first, r.stride, extra.columns.type, false});
        const double scale = options & kScale ? load<double>(d + 112 + 8 * k) : 1;
        const double offset = options & kOffset ? load<double>(d + 136 + 8 * k) : 0;
        if (options & (kScale | kOffset)) extra.scaling.push_back({scale, offset, 0});
      }
      extras.push_back(std::move(extra));
    }
  }
  return extras;
}

/// Adds extras that are not 0 everywhere, without duplicate names.
void add_extras(const Input& in, const std::vector<LasExtra>& extras, std::size_t n, AttributeTable& table) {
  std::vector<NamedColumns> plain;
  plain.reserve(extras.size());
  for (const LasExtra& extra : extras) plain.push_back(extra.columns);
  for (Attribute a : decode_attributes(in, plain, n, false)) {
    const bool zero = std::visit(
        [](const auto& values) { return std::all_of(values.begin(), values.end(), [](auto v) { return v == 0; }); },
        a.values);
    if (zero) continue;
    if (table.find(a.name)) {
      in.warn(fmt::format("'{}' occurs twice: the second one was left out", printable(a.name, 80)));
      continue;
    }
    const auto of =
        std::find_if(extras.begin(), extras.end(), [&](const LasExtra& extra) { return extra.columns.name == a.name; });
    if (of->scaling.empty()) {
      table.set(std::move(a));
      continue;
    }
    std::vector<double> values(a.size());
    parallel_for(0, values.size(), 1 << 15, [&](std::size_t i) {
      const Vec3& scaling = of->scaling[i % a.components];
      values[i] = a.number(i) * scaling.x + scaling.y;
    });
    table.set(a.name, std::move(values), a.components);
  }
}

/// Interpretation of 16-bit colours.
enum class ColorDepth {
  none,        ///< all are 0: many writers choose a format with colours and leave them empty
  bytes,       ///< at most 255, as some writers store them
  high_bytes,  ///< bytes times 256 or 257: the upper byte is the value
  words,
};

ColorDepth color_depth(const LasRecords& r, std::size_t offset) {
  struct Seen {
    unsigned low = 0;     // bits of lower bytes
    bool uneven = false;  // some lower byte differs from the upper one
    bool beyond = false;  // some value exceeds 255
  };
  const Seen seen = parallel_reduce(
      r.count, 1 << 15, Seen{},
      [&](std::size_t first, std::size_t last) {
        Seen s;
        for (std::size_t i = first; i < last; ++i)
          for (std::size_t k = 0; k < 3; ++k) {
            const unsigned c = r.at<std::uint16_t>(i, offset + 2 * k);
            s.low |= c & 255u, s.uneven |= (c & 255u) != c >> 8, s.beyond |= c > 255;
          }
        return s;
      },
      [](Seen a, const Seen& b) {
        a.low |= b.low, a.uneven |= b.uneven, a.beyond |= b.beyond;
        return a;
      });
  if (!seen.beyond) return seen.low == 0 ? ColorDepth::none : ColorDepth::bytes;
  return seen.low == 0 || !seen.uneven ? ColorDepth::high_bytes : ColorDepth::words;
}

/// Reports data that a cloud cannot hold.
void report_skipped_of_las(const Input& in, const LasRecords& r) {
  if (r.format == 4 || r.format == 5 || r.format >= 9) in.unread("waveforms");
  const std::size_t first = r.wide() ? 15 : 14;
  unsigned bits = 0, flags = 0;
  for (std::size_t i = 0; i < r.count; ++i) bits |= r.byte(i, first), flags |= r.flags(i);
  if (bits & 0xc0) in.unread("scan directions and edges of flight lines");
  if (r.wide() && (bits & 0x30)) in.unread("scanner channels");
  if (flags & 2) in.unread("flags of key points");
}

/// Removes points that the file marks as withheld. False if no others are among the selected records.
bool leave_out_withheld(const Input& in, const LasHeader& header, const LasRecords& r, PointSet& points) {
  std::vector<std::uint8_t> withheld(r.count);
  parallel_for(0, r.count, 1 << 15,
               [&](std::size_t i) { withheld[i] = static_cast<std::uint8_t>((r.flags(i) & kWithheld) != 0); });
  const auto lost = static_cast<std::size_t>(std::count(withheld.begin(), withheld.end(), std::uint8_t{1}));
  if (lost == 0) return true;
  if (lost == r.count && (in.options.box || r.count < header.count)) return false;
  if (lost == r.count) in.fail(fmt::format("holds no valid points: all {} are flagged as withheld", grouped(lost)));
  remove_samples(points, withheld);
  in.warn(fmt::format("{} of {} points are flagged as withheld and were left out", grouped(lost), grouped(r.count)));
  return true;
}

Vec3 record_position(const LasHeader& header, const char* record) {
  Vec3 p;
  for (std::size_t k = 0; k < 3; ++k) p[k] = header.scale[k] * load<std::int32_t>(record + 4 * k) + header.offset[k];
  return p;
}

}  // namespace

void keep_records_in(const LasHeader& header, const Box3& box, std::span<const char> records, std::vector<char>& kept) {
  for (std::size_t i = 0; i + header.record <= records.size(); i += header.record) {
    const char* const record = records.data() + i;
    if (box.contains(record_position(header, record))) kept.insert(kept.end(), record, record + header.record);
  }
}

bool any_record_in(const LasHeader& header, const Box3& box, std::span<const char> records) {
  for (std::size_t i = 0; i + header.record <= records.size(); i += header.record)
    if (box.contains(record_position(header, records.data() + i))) return true;
  return false;
}

PointSet decode_las_points(const Input& in, const LasHeader& header, std::span<const char> bytes,
                           std::span<const char> all) {
  const std::size_t n = bytes.size() / header.record;
  const char* const first = bytes.data();
  CloudColumns columns;
  const LasRecords records{first, header.record, n, header.format, header.minor == 0};
  LasRecords judged = records;
  if (!all.empty()) judged.first = all.data(), judged.count = all.size() / header.record;
  const std::size_t rgb = header.colors();
  const ColorDepth depth = rgb ? color_depth(judged, rgb) : ColorDepth::none;
  if (depth == ColorDepth::bytes && judged.count < header.count)
    in.warn(
        "the colours of the selected points are at most 255 and were read as 8-bit colours: if the file has 16-bit "
        "colours, they are too bright");
  columns.wide_colors = depth == ColorDepth::words;
  for (std::size_t k = 0; k < 3; ++k) {
    columns.position[k] = {first + 4 * k, header.record, NumberType::i32, false};
    if (depth == ColorDepth::high_bytes)
      columns.color[k] = {first + rgb + 2 * k + 1, header.record, NumberType::u8, false};
    else if (depth != ColorDepth::none)
      columns.color[k] = {first + rgb + 2 * k, header.record, NumberType::u16, false};
  }
  PointSet points;
  decode_columns(in, columns, n, points, header.scale, header.offset);
  points.attributes = las_attributes(records);
  add_extras(in, find_extras(in, header, records, kLasRecordBytes[header.format]), n, points.attributes);
  report_skipped_of_las(in, records);
  if (depth == ColorDepth::words) in.unread("the lower 8 of the 16 bits of colours");
  if (!leave_out_withheld(in, header, records, points)) return {};
  finish(in, points);
  return points;
}

}  // namespace sansmesh::inline v1::io
