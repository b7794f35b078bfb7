// Options of surfaces of samples that are never meshed, or cut out as they stand.
#pragma once

#include <optional>
#include <string>

#include "sansmesh/model/surface_model.h"

namespace CLI {
class App;
}

namespace sansmesh::cli {

struct SurfaceArguments {
  SurfaceOptions options;
  std::string name;  ///< of --surface; empty: not given
  bool no_sheets = false;

  /// How the surface is made, whatever its name.
  SurfaceOptions details() const;
  /// All that was said about it; nothing if it was not named. Throws ArgumentError.
  std::optional<SurfaceOptions> chosen() const;
};

/// --sharp, --smoothing, --bandwidth, …, --remove-outliers
void add_surface_details(CLI::App& command, SurfaceArguments& arguments);
/// --surface, and these. `what` says what is done with it.
void add_surface(CLI::App& command, SurfaceArguments& arguments, const std::string& what);

}  // namespace sansmesh::cli
