// Adds file names to errors of scenes and bodies.
#pragma once

#include <string>
#include <utility>

#include "sansmesh/error.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/simulate_options.h"

namespace sansmesh::inline v1 {

/// Calls `call`; errors of the scene become errors of the scene file, errors of the body those of the body's file.
/// Empty names are ignored.
template <class Call>
decltype(auto) with_files(const std::string& body, const std::string& scene, Call&& call) {
  try {
    return with_file(body, std::forward<Call>(call));
  } catch (const SceneError& error) {
    if (scene.empty()) throw;
    throw FileError(scene, error.what());
  }
}

}  // namespace sansmesh::inline v1
