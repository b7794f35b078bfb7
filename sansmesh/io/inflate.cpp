#include "sansmesh/io/inflate.h"

#include <fmt/core.h>
#include <zlib.h>

#include <algorithm>

#include "sansmesh/core/cancel_scope.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1::io {
namespace {

constexpr std::size_t kRoomForTheEnd = 64, kFirstRoom = std::size_t{1} << 16;

}  // namespace

Inflated inflate_bytes(const std::string& file, std::string_view packed, std::size_t expected, std::size_t limit) {
  Inflated result;
  z_stream z{};
  if (inflateInit2(&z, 15 + 32) != Z_OK) throw FileError(file, "cannot start unpacking");  // 32: zlib or gzip
  struct End {
    z_stream& z;
    ~End() { inflateEnd(&z); }
  } end{z};
  // Reserves memory for the expected size, plus enough to detect the end; pages are allocated only when written.
  result.bytes.reserve(std::min({expected, limit, packed.size() * kMostExpansion}) + kRoomForTheEnd);
  std::size_t used = 0, consumed = 0;
  for (;;) {
    check_cancelled();
    if (used == result.bytes.size()) {
      if (used >= limit) throw FileError(file, fmt::format("unpacks to more than {} bytes, refused", grouped(limit)));
      const std::size_t room = result.bytes.capacity(), next = std::max(kFirstRoom, used * 2);
      result.bytes.resize(std::min(limit, used < room ? std::min(room, next) : next));
    }
    const std::size_t in_now =
        std::min<std::size_t>(packed.size() - consumed, 1u << 22);  // in blocks, so that cancellation is checked
    const std::size_t out_now = std::min<std::size_t>(result.bytes.size() - used, 1u << 30);
    z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + consumed));
    z.avail_in = static_cast<uInt>(in_now);
    z.next_out = reinterpret_cast<Bytef*>(result.bytes.data() + used);
    z.avail_out = static_cast<uInt>(out_now);
    const int status = inflate(&z, Z_NO_FLUSH);
    consumed += in_now - z.avail_in;
    used += out_now - z.avail_out;
    if (status == Z_STREAM_END) {
      // gzip files may contain several streams.
      if (consumed + 2 <= packed.size() && packed[consumed] == '\x1f' && packed[consumed + 1] == '\x8b') {
        inflateReset(&z);
        continue;
      }
      result.complete = true;
      break;
    }
    if (status == Z_BUF_ERROR || (status == Z_OK && z.avail_out > 0)) {
      if (consumed >= packed.size() && z.avail_out > 0) break;
      if (status == Z_OK || z.avail_out == 0) continue;
      break;
    }
    if (status != Z_OK) throw FileError(file, fmt::format("damaged compressed data ({})", z.msg ? z.msg : "zlib"));
  }
  result.bytes.resize(used);
  return result;
}

}  // namespace sansmesh::inline v1::io
