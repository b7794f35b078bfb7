// Compressed data.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sansmesh::inline v1::io {

/// What came out of compressed data.
struct Inflated {
  std::vector<char> bytes;
  bool complete = false;  ///< the stream was whole
};

/// No byte of deflate makes more bytes than this: what is announced beyond it is not there.
inline constexpr std::uint64_t kMostExpansion = 1032;

/// Inflates zlib or gzip data (several gzip streams one after the other, too) to at most `limit` bytes; `expected` is
/// a guess of how many there will be. Memory is taken as they come: what a header promises and the data do not hold
/// takes none. Throws FileError, naming `file`, on damaged data and beyond the limit.
Inflated inflate_bytes(const std::string& file, std::string_view packed, std::size_t expected, std::size_t limit);

}  // namespace sansmesh::inline v1::io
