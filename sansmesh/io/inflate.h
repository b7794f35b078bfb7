// Decompression of zlib and gzip data.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sansmesh::inline v1::io {

/// Result of decompression.
struct Inflated {
  std::vector<char> bytes;
  bool complete = false;  ///< the stream ended properly
};

/// Largest expansion factor of deflate; sizes announced beyond it are wrong.
inline constexpr std::uint64_t kMostExpansion = 1032;

/// Decompresses zlib or gzip data (also several gzip streams in sequence) to at most `limit` bytes; `expected` is an
/// estimate of the size. Memory grows with the output: sizes that a header only announces allocate nothing. Throws
/// FileError, naming `file`, if the data are damaged or exceed the limit.
Inflated inflate_bytes(const std::string& file, std::string_view packed, std::size_t expected, std::size_t limit);

}  // namespace sansmesh::inline v1::io
