// Runs programs of tests/oracles, with which tests compare results.
#pragma once

#include <sys/wait.h>

#include <cstdio>
#include <cstring>
#include <string>

#include "support/places.h"

namespace sansmesh::test {

/// Output of `node SCRIPT ARGUMENTS`; `absent` if node or the package that the script needs is not installed.
inline std::string run_oracle(const std::string& script, const std::string& arguments, bool& absent) {
  const std::string command = "node '" + source_file("tests/oracles/" + script) + "' " + arguments + " 2>/dev/null";
  FILE* const pipe = ::popen(command.c_str(), "r");
  std::string text;
  char part[1 << 12];
  for (std::size_t n = 0; pipe && (n = std::fread(part, 1, sizeof part, pipe)) > 0;) text.append(part, n);
  const int status = pipe ? ::pclose(pipe) : -1;
  absent = !pipe || (WIFEXITED(status) && (WEXITSTATUS(status) == 77 || WEXITSTATUS(status) == 127));
  return text;
}

/// The number at a place in the bytes of a file.
template <class T>
T load_number(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

}  // namespace sansmesh::test
