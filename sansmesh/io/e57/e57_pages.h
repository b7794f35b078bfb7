// Pages of an E57 file (ASTM E2807): 1,020 bytes of content and their checksum.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "sansmesh/io/input.h"

namespace sansmesh::inline v1::io {

/// Content of a part of the file without checksums, followed by 16 zero bytes, so that words can be read at its end.
struct E57Bytes {
  std::unique_ptr<char[]> data;
  std::size_t size = 0;

  std::string_view view() const { return {data.get(), size}; }
};

/// Reads parts of the file. The format has physical offsets (positions in the file) and logical lengths (without
/// checksums). Only pages that are read are checked, so that damaged pictures do not matter.
class E57Pages {
 public:
  /// Checks the header. Throws FileError if the file is truncated or of another version.
  explicit E57Pages(const Input& in);

  /// Content of the XML section. Throws FileError if it has more than 64 MiB: its tree takes up to 30 times as much.
  E57Bytes xml() const;
  /// `length` bytes of content at a position in the file. Throws FileError if they are not in the file, or if a page
  /// does not match its checksum; the message names `what`, and the first such page.
  E57Bytes read(std::uint64_t offset, std::uint64_t length, const char* what) const;
  /// Logical offset of a position in the file. Throws FileError if it is not in the content of a page.
  std::uint64_t logical(std::uint64_t offset, const char* what) const;

 private:
  const Input& in_;
  std::uint64_t pages_ = 0;  ///< whole pages in the file
  std::uint64_t xml_offset_ = 0, xml_length_ = 0;
};

}  // namespace sansmesh::inline v1::io
