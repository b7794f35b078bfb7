// --cut of deformations: half-planes, polygons and meshes that they do not reach through.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "json.h"
#include "sansmesh/core/box.h"
#include "sansmesh/deform/occluder.h"

namespace sansmesh::cli {

class CommandLine;

struct CutArguments {
  std::vector<std::string> cuts;
  double damping = 1;
  bool open = false;  ///< meshes are left open along cuts

  /// Throws ArgumentError for what does not go together.
  void check() const;
};

/// --cut, --cut-damping, --cut-open
void add_cut_options(CommandLine& command, CutArguments& cuts);

/// "half-plane(x,y,z; x,y,z; x,y,z)": a point of its edge, its normal, and where it extends to; "polygon(x,y,z; …)"
/// with
/// "|" before each hole; or the name of a mesh. Reads that. `domain` holds handles and what is deformed. Throws
/// ArgumentError, FileError.
std::shared_ptr<const Occluder> cut_of(const std::string& text, const Box3& domain);

}  // namespace sansmesh::cli
