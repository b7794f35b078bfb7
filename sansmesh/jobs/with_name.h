// Errors of data with the name of what they are about.
#pragma once

#include <string>
#include <utility>

#include "sansmesh/error.h"

namespace sansmesh::inline v1 {

/// Calls; a DataError gets the name in front: "scan.ply: holds no points".
template <class Call>
decltype(auto) with_name(const std::string& name, Call&& call) {
  try {
    return std::forward<Call>(call)();
  } catch (const DataError& error) {
    throw DataError(printable(name, 200) + ": " + error.what());
  }
}

/// Calls; a DataError becomes one of the file, if that has a name.
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
