// LAS 1.0 to 1.4, uncompressed, point formats 0 to 10 (ASPRS LAS specification).
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "sansmesh/core/number_words.h"
#include "sansmesh/io/assemble_points.h"
#include "sansmesh/io/columns.h"
#include "sansmesh/io/readers.h"

namespace sansmesh::io {
namespace {

/// Where a point format keeps red, green and blue (16 bits each); 0 = it has none.
constexpr std::size_t las_colors(unsigned format) {
  switch (format) {
    case 2:
      return 20;
    case 3:
    case 5:
      return 28;
    case 7:
    case 8:
    case 10:
      return 30;
    default:
      return 0;
  }
}

/// The records of a file as their format lays them out: formats 0 to 5 in one way, 6 to 10 in another.
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
  /// Synthetic, key point, withheld, overlap: from bit 0 on. Formats 0 to 5 have no overlap but a class for it.
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

/// What io.h says of LAS.
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
  // LAS 1.0 had a "file marker", the number of a flight line among those merged, and let users have the two bytes
  // after it.
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

/// Points that the file marks as no longer part of it.
void leave_out_withheld(const Input& in, const LasRecords& r, PointSet& points) {
  std::vector<std::uint8_t> withheld(r.count);
  parallel_for(0, r.count, 1 << 15,
               [&](std::size_t i) { withheld[i] = static_cast<std::uint8_t>((r.flags(i) & kWithheld) != 0); });
  const auto lost = static_cast<std::size_t>(std::count(withheld.begin(), withheld.end(), std::uint8_t{1}));
  if (lost == 0) return;
  if (lost == r.count)
    in.fail(fmt::format("holds no points that count: all {} are flagged as withheld", grouped(lost)));
  remove_samples(points, withheld);
  in.warn(fmt::format("{} of {} points are flagged as withheld and were left out", grouped(lost), grouped(r.count)));
}

}  // namespace

PointSet read_las(const Input& in) {
  const char* const data = in.bytes.data();
  const std::size_t size = in.bytes.size();
  if (!in.bytes.starts_with("LASF")) in.fail("is not a LAS file (does not begin with 'LASF')");
  if (size < 227) in.fail_truncated(227 - size, true);
  const unsigned major = load<std::uint8_t>(data + 24), minor = load<std::uint8_t>(data + 25);
  in.report.format = fmt::format("LAS {}.{}", major, minor);
  if (major != 1 || minor > 4)
    in.fail(fmt::format("unsupported LAS version {}.{} (1.0 to 1.4 are read)", major, minor));
  const std::size_t begin = load<std::uint32_t>(data + 96);
  const unsigned format_byte = load<std::uint8_t>(data + 104);
  const std::size_t record = load<std::uint16_t>(data + 105);
  if (format_byte & 0xc0) in.fail("is LAZ (compressed LAS), which is not supported; decompress it to LAS first");
  if (format_byte > 10) in.fail(fmt::format("unsupported LAS point format {}", format_byte));
  std::uint64_t count = load<std::uint32_t>(data + 107);
  if (minor >= 4) {
    if (size < 375) in.fail_truncated(375 - size, true);
    const std::uint64_t wide = load<std::uint64_t>(data + 247);
    if (wide > 0) count = wide;
  }
  constexpr std::size_t least_record[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
  if (record < least_record[format_byte] || begin < 227) {
    in.fail(fmt::format("malformed LAS header: records of {} bytes for point format {}", record, format_byte));
  }
  if (count == 0) in.fail("holds no points");
  if (begin > size) in.fail_truncated(begin - size, true);
  if (count > (size - begin) / record) {
    if (count > (std::uint64_t{1} << 40)) in.fail(fmt::format("malformed LAS header: announces {} points", count));
    in.fail_truncated(count * record - (size - begin));
  }
  Vec3 scale, offset;
  for (std::size_t k = 0; k < 3; ++k) {
    scale[k] = load<double>(data + 131 + 8 * k);
    offset[k] = load<double>(data + 155 + 8 * k);
  }
  if (!is_finite(scale) || !is_finite(offset) || scale.x == 0 || scale.y == 0 || scale.z == 0) {
    in.fail("malformed LAS header: scale or offset is zero or not finite");
  }
  const std::size_t n = static_cast<std::size_t>(count);
  CloudColumns columns;
  for (std::size_t k = 0; k < 3; ++k) {
    columns.position[k] = {data + begin + 4 * k, record, NumberType::i32, false};
    if (const std::size_t rgb = las_colors(format_byte)) {
      columns.color[k] = {data + begin + rgb + 2 * k, record, NumberType::u16, false};
    }
  }
  PointSet points;
  decode_columns(in, columns, n, points, scale, offset);
  // Many writers choose a format with colours and leave them all zero.
  const bool black = std::all_of(points.colors.begin(), points.colors.end(),
                                 [](const auto& c) { return c[0] == 0 && c[1] == 0 && c[2] == 0; });
  if (black) points.colors.clear();
  const LasRecords records{data + begin, record, n, format_byte, minor == 0};
  points.attributes = las_attributes(records);
  leave_out_withheld(in, records, points);
  finish(in, points);
  return points;
}

}  // namespace sansmesh::io
