// Reads text files and pipes without memory mapping.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sansmesh::inline v1 {

/// Names of standard input and output. A suffix gives the format: "/dev/stdout.ply".
inline constexpr std::string_view kStandardInput = "/dev/stdin", kStandardOutput = "/dev/stdout";

/// Reads a whole small file (a script, handles, a transfer function). Throws FileError if it is missing, a folder, a
/// device, unreadable or larger than 256 MiB.
std::string read_text(const std::string& file);

namespace detail {

/// Returns the file to open for a name: /dev/stdin for "/dev/stdin.csv", /dev/stdout for "/dev/stdout.ply", whose
/// suffix gives the format. Returns other names unchanged.
std::string file_to_open(const std::string& name);

/// Opens a file for reading without waiting for the writer of a pipe. Throws FileError.
int open_to_read(const std::string& file);

/// Reads a descriptor of open_to_read to its end and waits for writers of a pipe; a CancelScope can end it with
/// Cancelled. Throws FileError beyond `most` bytes.
std::vector<char> read_to_end(const std::string& file, int fd, std::size_t most);

/// Waits until the descriptor is ready for `events` of poll(); a CancelScope can end it with Cancelled.
void wait_for(int fd, short events);

/// Closes a descriptor at the end of a scope.
struct Descriptor {
  int fd = -1;
  explicit Descriptor(int opened) : fd(opened) {}
  ~Descriptor();
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
};

}  // namespace detail
}  // namespace sansmesh::inline v1
