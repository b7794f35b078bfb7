// Options of surfaces of samples that are never meshed, or cut out as they stand.
#pragma once

#include <optional>
#include <string>

#include "sansmesh/model/surface_model.h"
#include "sansmesh/points/prepare_cloud.h"

namespace sansmesh::cli {

class CommandLine;

struct SurfaceArguments {
  SurfaceOptions options;
  std::optional<std::string> method;  ///< of --surface, if it was given

  /// All that was said about it; nothing if it was not named. Throws ArgumentError.
  std::optional<SurfaceOptions> chosen() const;
};

/// --surface, and all of its options, of a command that has a surface without it.
void add_surface(CommandLine& command, SurfaceOptions& surface, CloudPreparation& cloud, const std::string& what);
/// --sharp, --smoothing, --bandwidth, …, --remove-outliers
void add_surface_details(CommandLine& command, SurfaceOptions& options, CloudPreparation& cloud);
/// --surface, and these. `what` says what is done with it.
void add_surface(CommandLine& command, SurfaceArguments& arguments, CloudPreparation& cloud, const std::string& what);
/// All surfaces with what they are, a line each, as part of a footer.
std::string surface_list();

}  // namespace sansmesh::cli
