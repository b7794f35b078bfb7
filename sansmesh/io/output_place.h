// Where an output goes.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>

namespace sansmesh::inline v1::io {

struct OutputPlace {
  std::filesystem::path path;  ///< behind the symbolic links that the name stands for, also where nothing is there yet
  bool exists = false;
  bool stream = false;  ///< a pipe or device, or what this process has open already: cannot be replaced
  bool pipe = false;
  int descriptor = -1;  ///< that the name stands for (/dev/stdout, /dev/fd/3)
  mode_t mode = 0;      ///< of what is there: permissions
};

/// Throws FileError where nothing can be written under that name.
OutputPlace find_output_place(const std::string& file);

/// Throws FileError for what the system said (errno).
[[noreturn]] void fail_output(const std::string& file, int error);

}  // namespace sansmesh::inline v1::io
