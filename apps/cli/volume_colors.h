// How a volume is seen in a picture: what --preset, --transfer, --opacity and --iso say, of all commands that draw one.
#pragma once

#include <string>
#include <vector>

#include "command_line.h"
#include "sansmesh/render/volume_options.h"

namespace sansmesh::cli {

struct VolumeColors {
  std::string preset, transfer;
  std::vector<std::string> isos;
  double opacity = 1;

  /// None of the options was given.
  bool usual() const { return preset.empty() && transfer.empty() && isos.empty() && opacity == 1; }
  /// Reads the transfer function's file. Throws FileError and ArgumentError.
  void put_into(VolumePictureOptions& options) const;
  void add_options(CommandLine& command, const char* group);
};

}  // namespace sansmesh::cli
