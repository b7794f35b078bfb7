// A deformation from files: handles, two registered meshes, or a map of displacements.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/jobs/deformation.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// One of `handles`, `handles_from` and `map`.
struct DeformationInput {
  std::string handles = {};                      ///< file (docs/formats/handles.md)
  std::vector<std::string> handles_from = {};    ///< two files whose vertices correspond: before, after
  std::vector<std::uint32_t> vertices = {};      ///< of these, which are handles
  std::optional<std::size_t> handle_count = {};  ///< instead: so many, far from each other; default: 30
  std::string map = {};                          ///< file of a lattice of displacements
  MlsDeformationOptions by = {};                 ///< of handles
  std::vector<std::string> cuts = {};            ///< each as read_cut reads it

  static const OptionSchema& schema();
  /// Throws ArgumentError for what does not go together.
  void validate() const;
};

/// Throws FileError for bad files, ArgumentError for bad options.
Deformation read_deformation(const DeformationInput& input, Progress& progress);

}  // namespace sansmesh::inline v1
