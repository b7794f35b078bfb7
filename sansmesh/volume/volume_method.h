// Reconstructions of volumes by name: what a method is, how its field is made, and the registry of all of them.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sansmesh/schema/registry.h"
#include "sansmesh/volume_field.h"

namespace sansmesh::inline v1 {

struct ReconstructionInput;

/// One reconstruction. Registered once, in its own source: library, command line, help and documentation know it from
/// there.
struct VolumeMethod {
  std::string_view name;     ///< as users write it: "mls-detail"
  std::string_view summary;  ///< a line
  std::string_view grids;    ///< on which grids: "all", "uniform and rectilinear"
  /// Throws ArgumentError for grids that it cannot be used on.
  std::unique_ptr<VolumeField> (*make)(ReconstructionInput input) = nullptr;
  std::span<const std::string_view> uses = {};  ///< names of the options that mean something to it
  bool fits = false;                            ///< it has coefficients, in single precision

  /// Those of the library in the order of sansmesh/volume/CMakeLists.txt, then those that programs add.
  static Registry<VolumeMethod>& registry();
};

/// By name. Throws ArgumentError naming all methods.
inline const VolumeMethod& volume_method(std::string_view name) { return VolumeMethod::registry().at(name); }

/// Names of those that use an option: "shepard, rbf, mls".
std::string methods_that_use(std::string_view option);

/// Those of each source that has some, in the order of CMakeLists.txt, from which the definition is made.
std::vector<std::span<const VolumeMethod>> own_volume_methods();

}  // namespace sansmesh::inline v1
