#include "sansmesh/volume/volume_method.h"

namespace sansmesh::inline v1 {

Registry<VolumeMethod>& VolumeMethod::registry() {
  static Registry<VolumeMethod> methods("reconstruction", own_volume_methods());
  return methods;
}

}  // namespace sansmesh::inline v1
