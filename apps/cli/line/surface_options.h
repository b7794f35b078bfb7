// Options of surfaces of samples.
#pragma once

#include <optional>
#include <string>

#include "sansmesh/model/surface_model.h"
#include "sansmesh/points/prepare_cloud.h"

namespace sansmesh::cli {

class CommandLine;

struct SurfaceArguments {
  SurfaceOptions options;
  std::optional<std::string> method;  ///< value of --surface, if given

  /// The options, if a surface was selected. Throws ArgumentError.
  std::optional<SurfaceOptions> chosen() const;
};

/// Adds --surface and its options, for a command that always has a surface.
void add_surface(CommandLine& command, SurfaceOptions& surface, CloudPreparation& cloud, const std::string& what);
/// --sharp, --smoothing, --bandwidth, …, --remove-outliers
void add_surface_details(CommandLine& command, SurfaceOptions& options, CloudPreparation& cloud);
/// Adds --surface and its options. `what` describes its use.
void add_surface(CommandLine& command, SurfaceArguments& arguments, CloudPreparation& cloud, const std::string& what);
/// All surfaces with their descriptions, one line each, as part of a footer.
std::string surface_list();

}  // namespace sansmesh::cli
