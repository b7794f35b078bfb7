// LAS 1.0 to 1.4, uncompressed, point formats 0 to 10 (ASPRS LAS specification).
#include <fmt/core.h>

#include "sansmesh/io/assemble_points.h"
#include "sansmesh/io/columns.h"
#include "sansmesh/io/readers.h"

namespace sansmesh::io {
namespace {

/// Where a point format keeps red, green and blue (16 bits each); 0 = it has none.
std::size_t color_offset(unsigned format) {
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
    if (const std::size_t rgb = color_offset(format_byte)) {
      columns.color[k] = {data + begin + rgb + 2 * k, record, NumberType::u16, false};
    }
  }
  PointSet points;
  decode_columns(columns, n, points, scale, offset);
  // Many writers choose a format with colours and leave them all zero.
  const bool black = std::all_of(points.colors.begin(), points.colors.end(),
                                 [](const auto& c) { return c[0] == 0 && c[1] == 0 && c[2] == 0; });
  if (black) points.colors.clear();
  finish(in, points);
  return points;
}

}  // namespace sansmesh::io
