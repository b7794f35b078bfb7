// What a reader gets: the bytes of a file, and where to put complaints about them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "sansmesh/error.h"
#include "sansmesh/io.h"

namespace sansmesh::inline v1::io {

/// Name (for messages), bytes, and where remarks go.
struct Input {
  const std::string& file;
  std::string_view bytes;
  ReadReport& report;
  std::optional<Vec3> origin = {};  ///< that the cloud is to have, for the sake of others; else chosen for it
  double smallest_extent = 0;       ///< of a cloud that is not a single place; for one whose origin is chosen

  [[noreturn]] void fail(const std::string& cause) const { throw FileError(file, cause); }
  /// "truncated: 1,234 bytes are missing".
  [[noreturn]] void fail_truncated(std::uint64_t missing_bytes, bool at_least = false) const;
  /// The same with what the file announces and holds: "truncated: 3 bytes are missing (of 24, 21 are there)".
  [[noreturn]] void fail_short(std::uint64_t announced_bytes, std::uint64_t held_bytes, bool at_least = false) const;
  void warn(const std::string& remark) const { report.warnings.push_back(printable(remark)); }
  /// Something in the file for which the data has no place.
  void unread(const std::string& what) const { report.unread.push_back(printable(what, 80)); }
};

}  // namespace sansmesh::inline v1::io
