// Names of all registered surface methods, for parameterised tests.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/model/surface_method.h"

namespace sansmesh::test {

inline std::vector<std::string> surface_names() {
  std::vector<std::string> names;
  for (const SurfaceMethod* const method : SurfaceMethod::registry().all()) names.emplace_back(method->name);
  return names;
}

}  // namespace sansmesh::test
