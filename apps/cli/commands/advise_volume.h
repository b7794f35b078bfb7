// Command `advise` for volumes.
#pragma once

#include <string>
#include <vector>

#include "cli/input/volume_input.h"
#include "cli/report/console.h"
#include "sansmesh/volumes.h"

namespace sansmesh::cli {

/// Advice on a volume, with the command that follows it.
struct RecommendedCommand {
  std::string aim, why, command;

  static const ReportSchema& schema();
};

/// File names quoted for a shell.
std::string shell_words(const std::vector<std::string>& names);

/// Prints recommendations and commands for a volume.
void run_volume_advise(const VolumeInput& input, Console& console);

}  // namespace sansmesh::cli
