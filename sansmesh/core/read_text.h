// Texts, pipes and waits: whatever is read without a map of memory.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sansmesh::inline v1 {

/// The names of standard input and output; with an ending behind them, "/dev/stdout.ply", which says the format.
inline constexpr std::string_view kStandardInput = "/dev/stdin", kStandardOutput = "/dev/stdout";

/// All of a small file (a script, handles, a transfer function). Throws FileError where it is missing, a folder, a
/// device, unreadable or larger than 256 MiB.
std::string read_text(const std::string& file);

namespace detail {

/// The file that is opened under a name: /dev/stdin of "/dev/stdin.csv" and /dev/stdout of "/dev/stdout.ply", in which
/// the ending says the format. Other names are their files'.
std::string file_to_open(const std::string& name);

/// Opens a file to read it, without waiting for the writer of a pipe. Throws FileError.
int open_to_read(const std::string& file);

/// All that comes out of a descriptor of open_to_read until its end; waits for the writers of a pipe, and ends with
/// Cancelled as CancelScope says. Throws FileError beyond `most` bytes.
std::vector<char> read_to_end(const std::string& file, int fd, std::size_t most);

/// Waits until the descriptor is ready for `events` of poll(); Cancelled as CancelScope says.
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
