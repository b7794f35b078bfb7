// Isosurfaces of volumes that change in time: a mesh for each of many moments.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "option_groups.h"
#include "volume_input.h"

namespace sansmesh::cli {

struct IsosurfaceFrames {
  bool unsteady = false;              ///< all steps of the file, or the files one after the other
  std::vector<double> times;          ///< as FlowInput::times
  std::optional<std::size_t> frames;  ///< as many as steps where not given
  std::optional<double> time_cell;    ///< of SpaceTimeOptions

  /// Throws ArgumentError for options that need others.
  void check() const;
};

/// --unsteady, --times, --frames, --time-cell
void add_isosurface_frames(CommandLine& command, IsosurfaceFrames& frames);

/// Reads the steps, cuts the surface out of space and time, and writes meshes at moments from the first step to the
/// last: NAME_0000.ply, …
void write_isosurface_frames(const VolumeInput& input, std::optional<double> value, const IsosurfaceOptions& options,
                             const IsosurfaceFrames& frames, const MeshOutput& output, Console& console);

}  // namespace sansmesh::cli
