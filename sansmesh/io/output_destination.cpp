#include "sansmesh/io/output_destination.h"

#include <errno.h>
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/stat.h>
#include <unistd.h>

#include <charconv>
#include <cstring>

#include "sansmesh/core/read_text.h"
#include "sansmesh/error.h"

namespace sansmesh::inline v1::io {
namespace {

constexpr int kMostLinks = 40;  // limit of the system

/// The descriptor that a name in /proc/self/fd represents; -1 if it is none.
int descriptor_of(const std::filesystem::path& path) {
  std::error_code failed;
  const auto folder = std::filesystem::canonical(path.parent_path(), failed);
  if (failed || folder != std::filesystem::canonical("/proc/self/fd", failed) || failed) return -1;
  const std::string name = path.filename().string();
  int number = -1;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  return error == std::errc() && end == name.data() + name.size() ? number : -1;
}

/// Follows symbolic links one by one, because the last one may name a file that does not exist yet.
void follow_links(const std::string& file, OutputDestination& destination) {
  for (int hop = 0; hop < kMostLinks; ++hop) {
    struct stat info {};
    if (::lstat(destination.path.c_str(), &info) != 0) {
      if (errno == ENOENT) return;
      fail_output(file, errno);
    }
    if (!S_ISLNK(info.st_mode)) return;
    destination.descriptor = descriptor_of(destination.path);
    if (destination.descriptor >= 0) return;
    std::error_code failed;
    const auto target = std::filesystem::read_symlink(destination.path, failed);
    if (failed) fail_output(file, failed.value());
    destination.path = target.is_absolute() ? target : destination.path.parent_path() / target;
  }
  fail_output(file, ELOOP);
}

/// Reason of a write error.
std::string reason_of(int error) {
  switch (error) {
    case EACCES:
    case EPERM:
      return "permission denied";
    case ENOENT:
      return "its folder does not exist";
    case ENOTDIR:
      return "its folder is a file";
    case EISDIR:
      return "it is a directory";
    case ENOSPC:
      return "the disk is full";
    case EDQUOT:
      return "the disk quota of this user is exceeded";
    case EFBIG:
      return "it exceeds the size limit of files, see ulimit -f";
    case EROFS:
      return "the file system is read-only";
    case ENAMETOOLONG:
      return "its name is too long";
    case ELOOP:
      return "its symbolic links form a loop";
    case EPIPE:
      return "its reader is gone";
    default:
      return std::strerror(error);
  }
}

}  // namespace

void fail_output(const std::string& file, int error) {
  throw FileError(file, "cannot be written (" + reason_of(error) + ")");
}

OutputDestination find_output_destination(const std::string& file) {
  if (file.empty()) throw FileError("(no name)", "the name of the file to write is empty");
  OutputDestination destination;
  destination.path = detail::file_to_open(file);
  follow_links(file, destination);
  struct stat info {};
  if (destination.descriptor >= 0) {
    const int flags = ::fcntl(destination.descriptor, F_GETFL);
    if (flags < 0 || (flags & O_ACCMODE) == O_RDONLY || ::fstat(destination.descriptor, &info) != 0)
      throw FileError(file, "cannot be written (it is not open for that)");
    destination.exists = destination.stream = true;
    destination.pipe = S_ISFIFO(info.st_mode);
    return destination;
  }
  if (::stat(destination.path.c_str(), &info) == 0) {
    destination.exists = true;
    if (S_ISDIR(info.st_mode)) fail_output(file, EISDIR);
    if (::access(destination.path.c_str(), W_OK) != 0) fail_output(file, errno);
    destination.stream = !S_ISREG(info.st_mode);
    destination.pipe = S_ISFIFO(info.st_mode);
    destination.mode = info.st_mode & 07777;
    if (destination.stream) return destination;
  }
  std::filesystem::path folder = destination.path.parent_path();
  if (folder.empty()) folder = ".";
  if (::stat(folder.c_str(), &info) != 0) fail_output(file, errno);
  if (!S_ISDIR(info.st_mode)) fail_output(file, ENOTDIR);
  if (::access(folder.c_str(), W_OK | X_OK) != 0) {
    if (errno == EROFS) fail_output(file, errno);
    throw FileError(file, "cannot be written (permission denied in its folder)");
  }
  return destination;
}

}  // namespace sansmesh::inline v1::io
