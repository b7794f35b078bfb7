// Look of a volume in a picture: what --preset, --transfer, --opacity-factor and --iso say, of all commands that
// draw one.
#pragma once

#include <string>

#include "command_line.h"
#include "sansmesh/volume_look.h"

namespace sansmesh::cli {

struct VolumeColors {
  VolumePictureOptions look;  ///< its preset, opacity and iso-surfaces
  std::string transfer;       ///< a file

  /// None of the options was given.
  bool usual() const { return transfer.empty() && options_set(look).empty(); }
  /// Reads the transfer function's file. Throws FileError and ArgumentError.
  void put_into(VolumePictureOptions& options) const;
  void add_options(CommandLine& command, const char* group);
};

}  // namespace sansmesh::cli
