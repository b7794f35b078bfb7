// Input of a reader: the bytes of a file, and the report that receives remarks.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "sansmesh/error.h"
#include "sansmesh/io.h"

namespace sansmesh::inline v1::io {

struct Input {
  const std::string& file;
  std::string_view bytes;
  ReadReport& report;
  std::optional<Vec3> origin =
      {};  ///< prescribed origin of the cloud, shared with other clouds; default: chosen for this cloud
  double smallest_extent = 0;  ///< least extent of a cloud of distinct points; checked if the origin is chosen
  ReadOptions options = {};

  [[noreturn]] void fail(const std::string& cause) const { throw FileError(file, cause); }
  /// Message: "truncated: 1,234 bytes are missing".
  [[noreturn]] void fail_truncated(std::uint64_t missing_bytes, bool at_least = false) const;
  /// The same with the announced and the existing size: "truncated: 3 bytes are missing (of 24, 21 are there)".
  [[noreturn]] void fail_short(std::uint64_t announced_bytes, std::uint64_t held_bytes, bool at_least = false) const;
  void warn(const std::string& remark) const { report.warnings.push_back(printable(remark)); }
  /// For formats whose points are not in levels of resolution.
  void warn_without_levels() const {
    if (options.resolution) warn("has no levels of resolution: all points were read");
  }
  /// Reports data of the file that the result cannot hold.
  void unread(const std::string& what) const { report.unread.push_back(printable(what, 80)); }
};

}  // namespace sansmesh::inline v1::io
