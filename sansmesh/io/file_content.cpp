#include "sansmesh/io/file_content.h"

#include <errno.h>
#include <fmt/core.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "sansmesh/core/cancel_scope.h"
#include "sansmesh/core/read_text.h"
#include "sansmesh/error.h"
#include "sansmesh/io/inflate.h"

namespace sansmesh::inline v1::io {
namespace {

constexpr std::size_t kMostStream = std::size_t{16} << 30;

/// Largest accepted size of `packed` bytes after decompression. Deflate cannot exceed 1032:1, and clouds stay far
/// below; small files may use the full ratio.
std::size_t expansion_limit(std::size_t packed) {
  const std::size_t always_fine = std::size_t{256} << 20;
  return std::max(always_fine, packed * 100);
}

}  // namespace

FileContent::FileContent(const std::string& file) {
  if (file.empty()) throw FileError("(no name)", "the name of the file is empty");
  check_cancelled();  // between any two of many files
  const detail::Descriptor d(detail::open_to_read(file));
  struct stat info {};
  if (::fstat(d.fd, &info) != 0) throw FileError(file, fmt::format("cannot be examined ({})", std::strerror(errno)));
  if (S_ISDIR(info.st_mode)) throw FileError(file, "is a directory, not a file");
  if (S_ISREG(info.st_mode)) {
    if (info.st_size == 0) throw FileError(file, "is empty (0 bytes)");
    map_size_ = static_cast<std::size_t>(info.st_size);
    map_ = ::mmap(nullptr, map_size_, PROT_READ, MAP_PRIVATE | MAP_POPULATE, d.fd, 0);
    if (map_ == MAP_FAILED) {
      map_ = nullptr;
      owned_ = detail::read_to_end(file, d.fd, kMostStream);
      bytes_ = {owned_.data(), owned_.size()};
    } else {
      bytes_ = {static_cast<const char*>(map_), map_size_};
    }
  } else if (S_ISFIFO(info.st_mode) || S_ISSOCK(info.st_mode)) {
    owned_ = detail::read_to_end(file, d.fd, kMostStream);
    bytes_ = {owned_.data(), owned_.size()};
  } else {
    throw FileError(file, "is a device, not a file");
  }
  if (bytes_.empty()) throw FileError(file, "is empty (0 bytes)");

  if (bytes_.size() >= 2 && bytes_[0] == '\x1f' && bytes_[1] == '\x8b') {
    gzipped_ = true;
    Inflated unpacked;
    try {
      unpacked = inflate_bytes(file, bytes_, 4 * bytes_.size(), expansion_limit(bytes_.size()));
    } catch (...) {
      if (map_) ::munmap(map_, map_size_);
      throw;
    }
    if (map_) ::munmap(map_, map_size_), map_ = nullptr;
    if (!unpacked.complete) throw FileError(file, "truncated: the gzip data ends early");
    if (unpacked.bytes.empty()) throw FileError(file, "is empty (0 bytes when unpacked)");
    owned_ = std::move(unpacked.bytes);
    bytes_ = {owned_.data(), owned_.size()};
  }
}

FileContent::~FileContent() {
  if (map_) ::munmap(map_, map_size_);
}

}  // namespace sansmesh::inline v1::io
