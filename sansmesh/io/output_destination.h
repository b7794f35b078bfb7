// Destination of an output file.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>

namespace sansmesh::inline v1::io {

struct OutputDestination {
  std::filesystem::path path;  ///< symbolic links resolved, also if the file does not exist yet
  bool exists = false;
  bool stream = false;  ///< a pipe, a device, or a file that this process has open: cannot be replaced
  bool pipe = false;
  int descriptor = -1;  ///< that the name denotes (/dev/stdout, /dev/fd/3)
  mode_t mode = 0;      ///< permissions of the existing file
};

/// Throws FileError if nothing can be written under that name.
OutputDestination find_output_destination(const std::string& file);

/// Throws FileError for a system error (errno).
[[noreturn]] void fail_output(const std::string& file, int error);

}  // namespace sansmesh::inline v1::io
