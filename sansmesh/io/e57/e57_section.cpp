#include "sansmesh/io/e57/e57_section.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "sansmesh/core/number_words.h"
#include "sansmesh/core/parallel.h"
#include "sansmesh/io/binary.h"

namespace sansmesh::inline v1::io {
namespace {

constexpr std::size_t kSectionHeader = 32, kPacketHeader = 4, kDataHeader = 6;
constexpr unsigned char kDataPacket = 1, kVectorSection = 1;
constexpr std::size_t kStreamSlack = 16;

/// Calls use(k, number) for n numbers of `bits` bits (1 to 64), the lowest bit first. Reads up to 8 bytes behind the
/// last one.
template <class Use>
void each_number(const char* bytes, std::size_t first, std::size_t n, unsigned bits, Use&& use) {
  const std::uint64_t mask = bits == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
  std::uint64_t at = static_cast<std::uint64_t>(first) * bits;
  if (bits <= 57) {
    for (std::size_t k = 0; k < n; ++k, at += bits) use(k, (load<std::uint64_t>(bytes + (at >> 3)) >> (at & 7)) & mask);
    return;
  }
  for (std::size_t k = 0; k < n; ++k, at += bits) {
    const char* const p = bytes + (at >> 3);
    const unsigned shift = static_cast<unsigned>(at & 7);
    std::uint64_t number = load<std::uint64_t>(p) >> shift;
    if (shift > 0) number |= static_cast<std::uint64_t>(static_cast<unsigned char>(p[8])) << (64 - shift);
    use(k, number & mask);
  }
}

}  // namespace

unsigned E57Field::bits() const {
  switch (kind) {
    case E57Kind::integer:
    case E57Kind::scaled:
      return static_cast<unsigned>(
          std::bit_width(static_cast<std::uint64_t>(highest) - static_cast<std::uint64_t>(lowest)));
    case E57Kind::real32:
      return 32;
    case E57Kind::real64:
      return 64;
    case E57Kind::text:
      break;
  }
  return 0;
}

void E57Column::integers(std::size_t first, std::size_t n, std::int64_t* out) const {
  const unsigned bits = field_->bits();
  const auto lowest = static_cast<std::uint64_t>(field_->lowest);
  if (bits == 0) {
    std::fill_n(out, n, field_->lowest);
  } else {
    each_number(bytes_.data.get(), first, n, bits,
                [&](std::size_t k, std::uint64_t number) { out[k] = static_cast<std::int64_t>(lowest + number); });
  }
}

void E57Column::reals(std::size_t first, std::size_t n, double* out) const {
  const E57Field& f = *field_;
  if (f.kind == E57Kind::real64) {
    std::memcpy(out, bytes_.data.get() + 8 * first, 8 * n);
  } else if (f.kind == E57Kind::real32) {
    const char* const p = bytes_.data.get() + 4 * first;
    for (std::size_t k = 0; k < n; ++k) out[k] = static_cast<double>(load<float>(p + 4 * k));
  } else {
    const unsigned bits = f.bits();
    const double scale = f.scale, offset = f.offset;
    const auto lowest = static_cast<std::uint64_t>(f.lowest);
    const auto number_of = [=](std::uint64_t number) {
      return static_cast<double>(static_cast<std::int64_t>(lowest + number)) * scale + offset;
    };
    if (bits == 0) {
      std::fill_n(out, n, number_of(0));
    } else {
      each_number(bytes_.data.get(), first, n, bits,
                  [&](std::size_t k, std::uint64_t number) { out[k] = number_of(number); });
    }
  }
}

E57Section::E57Section(const Input& in, const E57Pages& pages, std::uint64_t offset, std::uint64_t records,
                       const std::vector<E57Field>& fields, const std::string& name)
    : fields_(fields), records_(records) {
  const std::string what = "scan " + name;
  const E57Bytes header = pages.read(offset, kSectionHeader, what.c_str());
  const char* const h = header.data.get();
  if (static_cast<unsigned char>(h[0]) != kVectorSection)
    in.fail(fmt::format("malformed E57: no section of points at byte {} ({})", offset, what));
  const auto length = load<std::uint64_t>(h + 8);
  if (length < kSectionHeader) in.fail(fmt::format("malformed E57: the section of {} has {} bytes", what, length));
  bytes_ = pages.read(offset, length, what.c_str());
  const auto data = load<std::uint64_t>(h + 16);
  const std::uint64_t start = pages.logical(offset, what.c_str()), first = pages.logical(data, what.c_str());
  if (first < start + kSectionHeader || first - start > length)
    in.fail(
        fmt::format("malformed E57: the points of {} are announced at byte {}, outside of their section", what, data));

  // A record has a bit at least, or the number of records could not be checked.
  std::vector<std::uint64_t> missing(fields.size());
  std::uint64_t bits = 0;
  for (std::size_t f = 0; f < fields.size(); ++f) {
    bits += fields[f].bits();
    if (records > length * 8 / std::max(1u, fields[f].bits())) {
      in.fail(fmt::format("truncated: {} announces {} points, more than its {} bytes can hold", what, grouped(records),
                          grouped(length)));
    }
    missing[f] = (records * fields[f].bits() + 7) / 8;
  }
  if (bits == 0) in.fail(fmt::format("malformed E57: the points of {} have no numbers", what));

  const char* const p = bytes_.data.get();
  std::size_t at = static_cast<std::size_t>(first - start);
  while (std::any_of(missing.begin(), missing.end(), [](std::uint64_t m) { return m > 0; })) {
    if (at == length) {
      const std::uint64_t most = *std::max_element(missing.begin(), missing.end());
      in.fail(fmt::format("truncated: the {} points of {} lack {} bytes", grouped(records), what, grouped(most)));
    }
    const auto bad = [&] { in.fail(fmt::format("malformed E57: a damaged packet in {}", what)); };
    if (length - at < kPacketHeader) bad();
    const std::size_t size = load<std::uint16_t>(p + at + 2) + std::size_t{1};
    if (size < kPacketHeader || size > length - at) bad();
    if (static_cast<unsigned char>(p[at]) == kDataPacket) {
      if (size < kDataHeader + 2 * fields.size() || load<std::uint16_t>(p + at + 4) != fields.size()) bad();
      const Packet packet{at + kDataHeader, at + kDataHeader + 2 * fields.size()};
      std::size_t used = packet.stream - at;
      for (std::size_t f = 0; f < fields.size(); ++f) {
        const std::size_t held = length_of(packet, f);
        used += held;
        missing[f] -= std::min<std::uint64_t>(missing[f], held);
      }
      if (used > size) bad();
      packets_.push_back(packet);
    }
    at += size;
  }
}

std::size_t E57Section::length_of(const Packet& packet, std::size_t field) const {
  return load<std::uint16_t>(bytes_.data.get() + packet.at + 2 * field);
}

E57Column E57Section::column(std::size_t field) const {
  const std::size_t size = static_cast<std::size_t>((records_ * fields_[field].bits() + 7) / 8);
  E57Column column;
  column.field_ = &fields_[field];
  column.bytes_ = {std::make_unique_for_overwrite<char[]>(size + kStreamSlack), size};
  char* const out = column.bytes_.data.get();
  std::memset(out + size, 0, kStreamSlack);
  struct Part {
    std::size_t from, to, length;
  };
  std::vector<Part> parts;
  std::size_t filled = 0;
  for (const Packet& packet : packets_) {
    std::size_t from = packet.stream;
    for (std::size_t f = 0; f < field; ++f) from += length_of(packet, f);
    const std::size_t length = std::min(length_of(packet, field), size - filled);
    parts.push_back({from, filled, length});
    filled += length;
  }
  parallel_for(0, parts.size(), 16, [&](std::size_t k) {
    std::memcpy(out + parts[k].to, bytes_.data.get() + parts[k].from, parts[k].length);
  });
  return column;
}

}  // namespace sansmesh::inline v1::io
