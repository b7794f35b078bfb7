// The steps of `convert` on the command line, in its order.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sansmesh/convert.h"

namespace sansmesh::cli {

class CommandLine;

struct ConvertSteps {
  std::vector<ConvertStep> steps;
  std::string from_unit, to_unit;
  std::optional<Vec3> about;  ///< fixed point of the rotations and scalings that follow
  bool about_center = false;
  bool about_waits = false;  ///< for a rotation or scaling after it

  /// Throws ArgumentError for options that do not fit together.
  void check() const;
};

/// --transform, --translate, …, --drop
void add_convert_steps(CommandLine& command, ConvertSteps& steps);

}  // namespace sansmesh::cli
