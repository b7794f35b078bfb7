#include "sansmesh/io/laz/laz_layout.h"

#include <fmt/core.h>

#include <cstring>
#include <vector>

#include "sansmesh/io/binary.h"

namespace sansmesh::inline v1::io::laz {
namespace {

/// Kinds of parts in the VLR.
enum class Part : std::uint16_t {
  bytes = 0,
  point10 = 6,
  time = 7,
  rgb = 8,
  wave = 9,
  point14 = 10,
  rgb14 = 11,
  rgb_infrared14 = 12,
  wave14 = 13,
  bytes14 = 14
};

struct Item {
  Part part;
  std::size_t bytes;
};

enum class Compressor : std::uint16_t { none, one_chunk, chunks, layered_chunks };

constexpr std::size_t kHeadBytes = 34, kItemBytes = 6;

std::vector<Item> laz_items(const LazLayout& l) {
  std::vector<Item> items;
  if (l.layered) {
    items.push_back({Part::point14, 30});
    if (l.infrared)
      items.push_back({Part::rgb_infrared14, 8});
    else if (l.rgb)
      items.push_back({Part::rgb14, 6});
    if (l.wave) items.push_back({Part::wave14, 29});
    if (l.extra_bytes) items.push_back({Part::bytes14, l.extra_bytes});
  } else {
    items.push_back({Part::point10, 20});
    if (l.time) items.push_back({Part::time, 8});
    if (l.rgb) items.push_back({Part::rgb, 6});
    if (l.wave) items.push_back({Part::wave, 29});
    if (l.extra_bytes) items.push_back({Part::bytes, l.extra_bytes});
  }
  return items;
}

unsigned version_of(Part part, const LazLayout& l) {
  if (part >= Part::point14) return l.fixed_channels ? 4 : 3;
  return part == Part::wave || l.first_version ? 1 : 2;
}

}  // namespace

LazLayout laz_layout(unsigned format, std::size_t record) {
  LazLayout l;
  l.layered = format >= 6;
  l.fixed_channels = false;
  l.record = record;
  std::size_t at = l.layered ? 30 : 20;
  const auto take = [&at](std::size_t bytes) {
    const std::size_t begin = at;
    at += bytes;
    return begin;
  };
  if (l.layered) l.time = 22;
  if (format == 1 || (format >= 3 && format <= 5)) l.time = take(8);
  if (format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10) l.rgb = take(6);
  if (format == 8 || format == 10) l.infrared = take(2);
  if (format == 4 || format == 5 || format == 9 || format == 10) l.wave = take(29);
  l.extra = at;
  l.extra_bytes = record - at;
  return l;
}

LazLayout read_laz_layout(const Input& in, const LasHeader& header) {
  const LasVlr* const vlr = header.find(kLazUser, kLazId);
  if (!vlr) in.fail("malformed LAZ header: the record that describes the compression is missing");
  const std::string_view bytes = vlr->payload;
  if (bytes.size() < kHeadBytes) in.fail("malformed LAZ header: the record that describes the compression is cut");
  const char* const p = bytes.data();
  const unsigned compressor = load<std::uint16_t>(p), coder = load<std::uint16_t>(p + 2);
  const std::size_t count = load<std::uint16_t>(p + 32);
  if (bytes.size() < kHeadBytes + count * kItemBytes)
    in.fail("malformed LAZ header: the record that describes the compression is cut");
  if (compressor > static_cast<unsigned>(Compressor::layered_chunks) || coder != 0)
    in.fail(fmt::format("unsupported LAZ compressor {} with coder {}", compressor, coder));
  LazLayout l = laz_layout(header.format, header.record);
  const std::vector<Item> items = laz_items(l);
  bool fits = count == items.size() && (compressor == static_cast<unsigned>(Compressor::layered_chunks)) == l.layered &&
              compressor != static_cast<unsigned>(Compressor::none);
  l.fixed_channels = l.layered;
  l.first_version = fits && !l.layered && load<std::uint16_t>(p + kHeadBytes + 4) == 1;
  for (std::size_t k = 0; k < count && fits; ++k) {
    const char* const item = p + kHeadBytes + k * kItemBytes;
    fits = load<std::uint16_t>(item) == static_cast<unsigned>(items[k].part) &&
           load<std::uint16_t>(item + 2) == items[k].bytes;
    const unsigned version = load<std::uint16_t>(item + 4);
    const bool known = l.layered ? version == 3 || version == 4 : version == version_of(items[k].part, l);
    if (fits && !known) in.fail(fmt::format("unsupported version {} of compressed LAZ records", version));
    if (version != 4) l.fixed_channels = false;
  }
  if (!fits) in.fail(fmt::format("malformed LAZ header: its compression does not fit point format {}", header.format));
  l.chunked = compressor != static_cast<unsigned>(Compressor::one_chunk);
  l.chunk_points = load<std::uint32_t>(p + 12);
  if (l.chunked && l.chunk_points == 0) in.fail("malformed LAZ header: chunks of 0 points");
  return l;
}

std::string laz_vlr(const LazLayout& layout) {
  const std::vector<Item> items = laz_items(layout);
  const std::size_t length = kHeadBytes + items.size() * kItemBytes;
  std::string s(kVlrHead + length, '\0');
  const auto put = [&s](std::size_t at, auto value) { std::memcpy(s.data() + at, &value, sizeof value); };
  s.replace(2, kLazUser.size(), kLazUser);
  put(18, kLazId), put(20, static_cast<std::uint16_t>(length));
  const std::size_t p = kVlrHead;
  put(p, layout.layered ? Compressor::layered_chunks : Compressor::chunks);
  s[p + 4] = layout.layered ? 3 : 2, s[p + 5] = layout.layered ? 4 : 2;  // version of the reference implementation
  put(p + 12, layout.chunk_points);
  put(p + 16, std::int64_t{-1}), put(p + 24, std::int64_t{-1});  // no special EVLRs
  put(p + 32, static_cast<std::uint16_t>(items.size()));
  for (std::size_t k = 0; k < items.size(); ++k) {
    const std::size_t at = p + kHeadBytes + k * kItemBytes;
    put(at, items[k].part), put(at + 2, static_cast<std::uint16_t>(items[k].bytes));
    put(at + 4, static_cast<std::uint16_t>(version_of(items[k].part, layout)));
  }
  return s;
}

}  // namespace sansmesh::inline v1::io::laz
