// Compressed data.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace sansmesh::io {

/// What came out of compressed data.
struct Inflated {
  std::vector<char> bytes;
  bool complete = false;  ///< the stream was whole
};

/// Inflates zlib or gzip data (several gzip streams one after the other, too) to at most `limit` bytes; `expected` is
/// a guess of how many there will be. Throws FileError, naming `file`, on damaged data and beyond the limit.
Inflated inflate_bytes(const std::string& file, std::string_view packed, std::size_t expected, std::size_t limit);

}  // namespace sansmesh::io
