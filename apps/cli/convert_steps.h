// What `convert` does to clouds and meshes between reading and writing, in the order of the command line.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cloud_or_mesh.h"
#include "console.h"

namespace sansmesh::cli {

class CommandLine;

/// One of them, with what it was told. `run` changes the data and returns what is to be said, if anything; it throws
/// DataError.
struct ConvertStep {
  std::string flag;  ///< "--crop"
  std::function<std::string(CloudOrMesh& data)> run;
};

struct ConvertSteps {
  std::vector<ConvertStep> steps;
  std::optional<double> from_unit, to_unit;  ///< metres
  std::optional<Vec3> about;                 ///< fixed point of the rotations and scalings that follow
  bool about_center = false;
  bool about_waits = false;  ///< for a rotation or scaling after it

  /// Throws ArgumentError for options that do not fit together.
  void check() const;
  /// All, one after the other. Remarks are appended to `said`; returns what was done. Throws DataError where a step
  /// leaves nothing.
  Json run(CloudOrMesh& data, Progress& progress, std::vector<std::string>& said) const;
};

/// --transform, --translate, …, --drop
void add_convert_steps(CommandLine& command, ConvertSteps& steps);

}  // namespace sansmesh::cli
