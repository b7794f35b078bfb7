// The deformation that a command is told: handles with a kind, or a map from a file.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "console.h"
#include "cut_options.h"
#include "json.h"
#include "sansmesh/core/box.h"
#include "sansmesh/data/triangle_mesh.h"
#include "sansmesh/deform/displacement_map.h"
#include "sansmesh/deform/handles.h"
#include "sansmesh/deform/mls_deformation.h"
#include "sansmesh/field/space_map.h"

namespace sansmesh::cli {

class CommandLine;

struct DeformationInput {
  std::string handles;  ///< file
  std::string pair;     ///< two files with a comma between them
  std::string vertices;
  std::size_t handle_count = 0;
  std::string map;  ///< file
  std::optional<DeformationKind> kind;
  std::optional<int> degree;
  std::optional<double> alpha;
  CutArguments cuts;

  /// Throws ArgumentError for what does not go together.
  void check() const;
};

/// --handles, --handles-from, --vertices, --handle-count, --map, --kind, --degree, --alpha, --cut, --cut-damping,
/// --cut-open
void add_deformation_options(CommandLine& command, DeformationInput& input);

/// The box with so much room around it, as a share of its diagonal.
Box3 with_room(const Box3& box, double share);

/// Both ways through one deformation.
struct DeformationMaps {
  std::shared_ptr<const SpaceMap> backward;  ///< from places after to places before: fields and volumes are seen by it
  std::shared_ptr<const SpaceMap> forward;   ///< the other way: meshes and clouds are moved by it
};

class OpenDeformation {
 public:
  /// Reads. Throws FileError, ArgumentError.
  OpenDeformation(const DeformationInput& input, Console& console);

  /// As far as it has come at a share of the way, 0..1; other than 1 needs handles.
  DeformationMaps at(double share) const;
  /// The handles there; none of a map.
  std::vector<Handle> handles_at(double share) const;
  bool has_handles() const { return !handles_.empty(); }
  const std::vector<std::shared_ptr<const Occluder>>& cuts() const { return cuts_; }
  /// About where what lies in `box` comes to lie; nothing where that is not known.
  std::optional<Box3> box_of(const DeformationMaps& maps, const Box3& box) const;
  /// Balls and arrows of the handles, for pictures of something so large.
  TriangleMesh shapes(double share, double size) const;

  /// "15 handles, rigid"
  std::string words() const;
  Json json() const;

 private:
  std::vector<Handle> handles_;
  std::vector<std::shared_ptr<const Occluder>> cuts_;
  MlsDeformationOptions options_;
  std::shared_ptr<const DisplacementMap> map_;
  std::string file_;
};

}  // namespace sansmesh::cli
