#include "sansmesh/model/surface_method.h"

#include <algorithm>

namespace sansmesh::inline v1 {

bool SurfaceMethod::uses_option(std::string_view option) const {
  return std::find(uses.begin(), uses.end(), option) != uses.end() ||
         std::any_of(own.begin(), own.end(), [&](const OptionRow& row) { return row.name == option; });
}

Registry<SurfaceMethod>& SurfaceMethod::registry() {
  static Registry<SurfaceMethod> methods("surface", own_surface_methods());
  return methods;
}

std::string surfaces_that_use(std::string_view option) {
  std::string text;
  for (const SurfaceMethod* const method : SurfaceMethod::registry().all())
    if (method->uses_option(option)) text += (text.empty() ? "" : ", ") + std::string(method->name);
  return text;
}

}  // namespace sansmesh::inline v1
