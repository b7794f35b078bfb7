// Registry of named volume reconstructions.
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

/// One reconstruction, registered in its own source; library, command line, help and documentation use the registry.
struct VolumeMethod {
  std::string_view name;     ///< user-visible name: "mls-detail"
  std::string_view summary;  ///< one line
  std::string_view grids;    ///< supported grids: "all", "uniform and rectilinear"
  /// Throws ArgumentError for unsupported grids.
  std::unique_ptr<VolumeField> (*make)(ReconstructionInput input) = nullptr;
  std::span<const std::string_view> uses = {};  ///< names of the options it uses
  bool fits = false;                            ///< it has coefficients, in single precision
  bool plain = false;                           ///< takes logarithms only if asked to: a baseline

  /// Methods of the library in the order of sansmesh/volume/CMakeLists.txt, then those added by programs.
  static Registry<VolumeMethod>& registry();
};

/// Throws ArgumentError that names all methods.
inline const VolumeMethod& volume_method(std::string_view name) { return VolumeMethod::registry().at(name); }

/// Names of the methods that use an option: "shepard, rbf, mls".
std::string methods_that_use(std::string_view option);

/// The methods of each source, in the order of CMakeLists.txt, from which the definition is generated.
std::vector<std::span<const VolumeMethod>> own_volume_methods();

}  // namespace sansmesh::inline v1
