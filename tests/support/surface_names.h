// The surfaces that are known by name, for tests that are run for each.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sansmesh/model/surface_methods.h"

namespace sansmesh::test {

/// All of them, or those of one family.
inline std::vector<std::string> surface_names(std::optional<SurfaceFamily> family = {}) {
  std::vector<std::string> names;
  for (const SurfaceMethodInfo& info : surface_methods())
    if (!family || info.family() == *family) names.emplace_back(info.name);
  return names;
}

}  // namespace sansmesh::test
