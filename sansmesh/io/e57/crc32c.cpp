#include "sansmesh/io/e57/crc32c.h"

#include <array>

#include "sansmesh/io/binary.h"

namespace sansmesh::inline v1::io {
namespace {

constexpr std::uint32_t kCastagnoli = 0x82f63b78;  ///< polynomial with its bits reversed
using CrcTables = std::array<std::array<std::uint32_t, 256>, 8>;

/// Table k advances the remainder of one byte by k further bytes, so that eight bytes take eight independent look-ups.
constexpr CrcTables make_tables() {
  CrcTables t = {};
  for (std::uint32_t b = 0; b < 256; ++b) {
    std::uint32_t r = b;
    for (int bit = 0; bit < 8; ++bit) r = (r >> 1) ^ ((r & 1) != 0 ? kCastagnoli : 0);
    t[0][b] = r;
  }
  for (std::size_t k = 1; k < 8; ++k)
    for (std::size_t b = 0; b < 256; ++b) t[k][b] = (t[k - 1][b] >> 8) ^ t[0][t[k - 1][b] & 255];
  return t;
}

constexpr CrcTables kCrcTables = make_tables();

}  // namespace

std::uint32_t crc32c(std::string_view bytes) {
  const char* p = bytes.data();
  const char* const end = p + bytes.size();
  std::uint32_t crc = 0xffffffff;
  for (; end - p >= 8; p += 8) {
    const std::uint64_t word = load<std::uint64_t>(p) ^ crc;
    crc = kCrcTables[7][word & 255] ^ kCrcTables[6][word >> 8 & 255] ^ kCrcTables[5][word >> 16 & 255] ^
          kCrcTables[4][word >> 24 & 255] ^ kCrcTables[3][word >> 32 & 255] ^ kCrcTables[2][word >> 40 & 255] ^
          kCrcTables[1][word >> 48 & 255] ^ kCrcTables[0][word >> 56];
  }
  for (; p != end; ++p) crc = (crc >> 8) ^ kCrcTables[0][(crc ^ static_cast<unsigned char>(*p)) & 255];
  return ~crc;
}

}  // namespace sansmesh::inline v1::io
