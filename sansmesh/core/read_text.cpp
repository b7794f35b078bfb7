#include "sansmesh/core/read_text.h"

#include <errno.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

#include "sansmesh/core/cancel_scope.h"
#include "sansmesh/core/number_words.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1 {
namespace {

constexpr int kTick = 100;  // milliseconds between two checks for cancellation
constexpr std::size_t kBlock = std::size_t{1} << 24;
constexpr std::size_t kMostTextBytes = std::size_t{1} << 28;

}  // namespace

namespace detail {

Descriptor::~Descriptor() {
  if (fd >= 0) ::close(fd);
}

std::string file_to_open(const std::string& name) {
  for (const std::string_view stream : {kStandardInput, kStandardOutput})
    if (name.starts_with(std::string(stream) + ".")) return std::string(stream);
  return name;
}

int open_to_read(const std::string& file) {
  // Without O_NONBLOCK, opening a named pipe blocks until a writer opens it.
  const int fd = ::open(file_to_open(file).c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd >= 0) return fd;
  if (errno == ENOENT || errno == ENOTDIR) throw FileError(file, "no such file");
  if (errno == EACCES) throw FileError(file, "permission to read it is denied");
  throw FileError(file, fmt::format("cannot be opened ({})", std::strerror(errno)));
}

void wait_for(int fd, short events) {
  for (;;) {
    check_cancelled();
    pollfd wanted{fd, events, 0};
    if (::poll(&wanted, 1, kTick) > 0) return;
  }
}

std::vector<char> read_to_end(const std::string& file, int fd, std::size_t most) {
  std::vector<char> bytes;
  std::size_t used = 0;
  // For a pipe without a writer yet, read() reports its end, but poll() waits. If all writers had closed before the
  // pipe was opened, poll() never reports an end once it is empty.
  bool waits = true;
  for (;;) {
    check_cancelled();
    if (waits) wait_for(fd, POLLIN);
    if (used == bytes.size()) bytes.resize(std::max<std::size_t>(1 << 16, bytes.size() * 2));
    const ssize_t got = ::read(fd, bytes.data() + used, std::min(bytes.size() - used, kBlock));
    waits = got < 0;
    if (got < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (got < 0) throw FileError(file, fmt::format("cannot be read ({})", std::strerror(errno)));
    if (got == 0) break;
    used += static_cast<std::size_t>(got);
    if (used > most) throw FileError(file, fmt::format("is a stream of more than {} bytes", grouped(most)));
  }
  bytes.resize(used);
  return bytes;
}

}  // namespace detail

std::string read_text(const std::string& file) {
  const detail::Descriptor d(detail::open_to_read(file));
  struct stat info {};
  if (::fstat(d.fd, &info) != 0) throw FileError(file, fmt::format("cannot be examined ({})", std::strerror(errno)));
  if (S_ISDIR(info.st_mode)) throw FileError(file, "is a directory, not a file");
  if (!S_ISREG(info.st_mode) && !S_ISFIFO(info.st_mode)) throw FileError(file, "is a device, not a file");
  const std::vector<char> bytes = detail::read_to_end(file, d.fd, kMostTextBytes);
  return {bytes.begin(), bytes.end()};
}

}  // namespace sansmesh::inline v1
