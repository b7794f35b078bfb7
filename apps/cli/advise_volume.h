// sansmesh advise, of volumes.
#pragma once

#include <string>

#include "console.h"
#include "sansmesh/volumes.h"
#include "volume_input.h"

namespace sansmesh::cli {

/// Advice on a volume, and the command that follows it.
struct ToldCommand {
  std::string aim, why, command;

  static const ReportSchema& schema();
};

/// A file's name as a shell takes it for one word.
std::string shell_word(const std::string& name);

/// What suits a volume, and the commands.
void run_volume_advise(const VolumeInput& input, Console& console);

}  // namespace sansmesh::cli
