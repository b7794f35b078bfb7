// Adds names to errors of data.
#pragma once

#include <string>
#include <utility>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

/// Calls `call` and prefixes DataError with the name: "scan.ply: holds no points".
template <class Call>
decltype(auto) with_name(const std::string& name, Call&& call) {
  try {
    return std::forward<Call>(call)();
  } catch (const DataError& error) {
    throw DataError(printable(name, 200) + ": " + error.what());
  }
}

/// Calls `call` and converts DataError to FileError if the file has a name.
template <class Call>
decltype(auto) with_file(const std::string& file, Call&& call) {
  try {
    return std::forward<Call>(call)();
  } catch (const DataError& error) {
    if (file.empty()) throw;
    throw FileError(file, error.what());
  }
}

}  // namespace sansmesh::inline v1
