// Errors of scenes and bodies with the files that they are of.
#pragma once

#include <string>
#include <utility>

#include "sansmesh/error.h"
#include "sansmesh/jobs/with_name.h"
#include "sansmesh/simulate_options.h"

namespace sansmesh::inline v1 {

/// Calls; what the scene says and cannot be is an error of its file, what the body cannot be of the body's. Empty names
/// are none.
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
