// sansmesh advise, of volumes.
#pragma once

#include <string>
#include <vector>

#include "cli/input/volume_input.h"
#include "cli/report/console.h"
#include "sansmesh/volumes.h"

namespace sansmesh::cli {

/// Advice on a volume, and the command that follows it.
struct ToldCommand {
  std::string aim, why, command;

  static const ReportSchema& schema();
};

/// Names of files as a shell takes them for one word each.
std::string shell_words(const std::vector<std::string>& names);

/// What suits a volume, and the commands.
void run_volume_advise(const VolumeInput& input, Console& console);

}  // namespace sansmesh::cli
