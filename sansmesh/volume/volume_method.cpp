#include "sansmesh/volume/volume_method.h"

#include <algorithm>

namespace sansmesh::inline v1 {

Registry<VolumeMethod>& VolumeMethod::registry() {
  static Registry<VolumeMethod> methods("reconstruction", own_volume_methods());
  return methods;
}

std::string methods_that_use(std::string_view option) {
  std::string text;
  for (const VolumeMethod* const method : VolumeMethod::registry().all())
    if (std::find(method->uses.begin(), method->uses.end(), option) != method->uses.end())
      text += (text.empty() ? "" : ", ") + std::string(method->name);
  return text;
}

}  // namespace sansmesh::inline v1
