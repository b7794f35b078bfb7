#include "sansmesh/io/points/las_header.h"

#include <fmt/core.h>

#include "sansmesh/io/binary.h"

namespace sansmesh::inline v1::io {
namespace {

/// A VLR or EVLR at `at`, which advances to the next one; nothing if it does not end before `end`.
bool take_vlr(std::string_view bytes, bool extended, std::size_t end, std::size_t& at, std::vector<LasVlr>& vlrs) {
  const std::size_t head = extended ? kEvlrHead : kVlrHead;
  if (at > end || end - at < head) return false;
  const char* const p = bytes.data() + at;
  const std::uint64_t length = extended ? load<std::uint64_t>(p + 20) : load<std::uint16_t>(p + 20);
  if (length > end - at - head) return false;
  const std::string_view user(p + 2, 16);
  vlrs.push_back({user.substr(0, user.find('\0')), load<std::uint16_t>(p + 18),
                  bytes.substr(at + head, static_cast<std::size_t>(length))});
  at += head + static_cast<std::size_t>(length);
  return true;
}

void read_vlrs(std::string_view bytes, LasHeader& h) {
  const char* const data = bytes.data();
  std::size_t at = h.header_bytes;
  for (std::uint32_t left = load<std::uint32_t>(data + 100); left > 0; --left)
    if (!take_vlr(bytes, false, h.begin, at, h.vlrs)) break;
  if (h.minor < 4) return;
  const std::uint64_t first = load<std::uint64_t>(data + 235);
  if (first < h.begin || first > bytes.size()) return;
  at = static_cast<std::size_t>(first);
  for (std::uint32_t left = load<std::uint32_t>(data + 243); left > 0; --left)
    if (!take_vlr(bytes, true, bytes.size(), at, h.vlrs)) break;
}

}  // namespace

std::size_t LasHeader::colors() const {
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

const LasVlr* LasHeader::find(std::string_view user, std::uint16_t id) const {
  for (const LasVlr& vlr : vlrs)
    if (vlr.id == id && vlr.user == user) return &vlr;
  return nullptr;
}

Box3 load_las_box(const char* header) {
  Box3 box;
  for (std::size_t k = 0; k < 3; ++k) {
    box.upper[k] = load<double>(header + 179 + 16 * k);
    box.lower[k] = load<double>(header + 187 + 16 * k);
  }
  return box;
}

LasHeader read_las_header(const Input& in) {
  const char* const data = in.bytes.data();
  const std::size_t size = in.bytes.size();
  if (!in.bytes.starts_with("LASF")) in.fail("is not a LAS file (does not begin with 'LASF')");
  if (size < kLasHeaderBytes) in.fail_truncated(kLasHeaderBytes - size, true);
  const unsigned major = load<std::uint8_t>(data + 24);
  LasHeader h;
  h.minor = load<std::uint8_t>(data + 25);
  const unsigned format_byte = load<std::uint8_t>(data + 104);
  h.compressed = (format_byte & 0x80) != 0;
  const char* const name = h.compressed ? "LAZ" : "LAS";
  in.report.format = fmt::format("{} {}.{}", name, major, h.minor);
  if (major != 1 || h.minor > 4)
    in.fail(fmt::format("unsupported {} version {}.{} (1.0 to 1.4 are read)", name, major, h.minor));
  h.global_encoding = load<std::uint16_t>(data + 6);
  h.header_bytes = load<std::uint16_t>(data + 94);
  h.begin = load<std::uint32_t>(data + 96);
  h.format = format_byte & 0x7f;
  h.record = load<std::uint16_t>(data + 105);
  if (h.format > 10) in.fail(fmt::format("unsupported {} point format {}", name, h.format));
  h.count = load<std::uint32_t>(data + 107);
  if (h.minor >= 4) {
    if (size < 375) in.fail_truncated(375 - size, true);
    const std::uint64_t wide = load<std::uint64_t>(data + 247);
    if (wide > 0) h.count = wide;
  }
  if (h.record < kLasRecordBytes[h.format] || h.begin < kLasHeaderBytes)
    in.fail(fmt::format("malformed {} header: records of {} bytes for point format {}", name, h.record, h.format));
  if (h.count == 0) in.fail("holds no points");
  if (h.begin > size) in.fail_short(h.begin, size, true);
  if (h.count > (std::uint64_t{1} << 40))
    in.fail(fmt::format("malformed {} header: announces {} points", name, h.count));
  if (!h.compressed && h.count > (size - h.begin) / h.record) in.fail_short(h.count * h.record, size - h.begin);
  for (std::size_t k = 0; k < 3; ++k) {
    h.scale[k] = load<double>(data + 131 + 8 * k);
    h.offset[k] = load<double>(data + 155 + 8 * k);
  }
  h.box = load_las_box(data);
  if (!is_finite(h.scale) || !is_finite(h.offset) || h.scale.x == 0 || h.scale.y == 0 || h.scale.z == 0)
    in.fail(fmt::format("malformed {} header: scale or offset is zero or not finite", name));
  read_vlrs(in.bytes, h);
  return h;
}

}  // namespace sansmesh::inline v1::io
