#include "sansmesh/io/file_content.h"

#include <errno.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "sansmesh/core/error.h"
#include "sansmesh/io/inflate.h"

namespace sansmesh::io {
namespace {

/// Closes a descriptor at the end of a scope.
struct Descriptor {
  int fd = -1;
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
};

/// Most bytes that `packed` bytes may expand to: deflate itself cannot exceed 1032:1, and clouds stay far below; small
/// files may use the full ratio.
std::size_t expansion_limit(std::size_t packed) {
  const std::size_t always_fine = std::size_t{256} << 20;
  return std::max(always_fine, packed * 100);
}

std::vector<char> read_stream(const std::string& file, int fd) {
  std::vector<char> bytes;
  std::size_t used = 0;
  const std::size_t limit = std::size_t{16} << 30;
  for (;;) {
    if (used == bytes.size()) bytes.resize(std::max<std::size_t>(1 << 16, bytes.size() * 2));
    const ssize_t got = ::read(fd, bytes.data() + used, bytes.size() - used);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) throw FileError(file, fmt::format("cannot be read ({})", std::strerror(errno)));
    if (got == 0) break;
    used += static_cast<std::size_t>(got);
    if (used > limit) throw FileError(file, "is a stream of more than 16 GiB");
  }
  bytes.resize(used);
  return bytes;
}

}  // namespace

FileContent::FileContent(const std::string& file) {
  if (file.empty()) throw FileError("(no name)", "the name of the file is empty");
  Descriptor d{::open(file.c_str(), O_RDONLY | O_CLOEXEC)};
  if (d.fd < 0) {
    if (errno == ENOENT || errno == ENOTDIR) throw FileError(file, "no such file");
    if (errno == EACCES) throw FileError(file, "permission to read it is denied");
    throw FileError(file, fmt::format("cannot be opened ({})", std::strerror(errno)));
  }
  struct stat info {};
  if (::fstat(d.fd, &info) != 0) throw FileError(file, fmt::format("cannot be examined ({})", std::strerror(errno)));
  if (S_ISDIR(info.st_mode)) throw FileError(file, "is a directory, not a file");
  if (S_ISREG(info.st_mode)) {
    if (info.st_size == 0) throw FileError(file, "is empty (0 bytes)");
    map_size_ = static_cast<std::size_t>(info.st_size);
    map_ = ::mmap(nullptr, map_size_, PROT_READ, MAP_PRIVATE | MAP_POPULATE, d.fd, 0);
    if (map_ == MAP_FAILED) {
      map_ = nullptr;
      owned_ = read_stream(file, d.fd);
      bytes_ = {owned_.data(), owned_.size()};
    } else {
      bytes_ = {static_cast<const char*>(map_), map_size_};
    }
  } else if (S_ISFIFO(info.st_mode) || S_ISSOCK(info.st_mode)) {
    owned_ = read_stream(file, d.fd);
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

}  // namespace sansmesh::io
