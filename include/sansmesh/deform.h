// Deformations of space with all that they need: by handles, or by a map of displacements.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/api.h"
#include "sansmesh/box.h"
#include "sansmesh/deform_options.h"
#include "sansmesh/grid_data.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/space_map.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

class Occluder;

/// Both ways through one deformation.
struct DeformationMaps {
  std::shared_ptr<const SpaceMap> backward;  ///< from places after to places before: fields and volumes are seen by it
  std::shared_ptr<const SpaceMap> forward;   ///< the other way: meshes and clouds are moved by it
};

/// A cut that handles do not reach through, as users write it. "half-plane(x,y,z; x,y,z; x,y,z)": a point of its edge,
/// its normal, and where it extends to; "polygon(x,y,z; …)" with "|" before each hole; or the name of a mesh. `domain`
/// holds handles and what is deformed. Throws ArgumentError, FileError.
SANSMESH_API std::shared_ptr<const Occluder> read_cut(const std::string& text, const Box3& domain);

/// A deformation of space. Cheap to copy: what it holds is shared and never changes.
class SANSMESH_API Deformation {
 public:
  /// By moving least squares. `name` stands in messages: the file of the handles, if there is one. Throws
  /// ArgumentError for bad options, and for handles that cannot be; FileError in its place where there is a name.
  explicit Deformation(std::vector<Handle> handles, const MlsDeformationOptions& options = {},
                       std::vector<std::shared_ptr<const Occluder>> cuts = {}, std::string name = {});
  /// By a backward map, whose inverse is found by Newton's method.
  explicit Deformation(std::shared_ptr<const SpaceMap> backward, std::string name = {});
  /// The same of displacements on a lattice, as deformation_map makes them. Throws DataError where it is no lattice of
  /// even spacing along the axes, or lacks the array, ArgumentError where it has no size.
  explicit Deformation(const GridBlock& displacements, std::string name = {});

  /// As far as it has come at a share of the way, 0..1; other than 1 means nothing to a map of displacements.
  DeformationMaps at(double share) const;
  /// The handles there; none of a map.
  std::vector<Handle> handles_at(double share) const;
  /// By handles, not by a map.
  bool has_handles() const;
  /// Where handles do not reach through.
  const std::vector<std::shared_ptr<const Occluder>>& cuts() const;
  /// About where what lies in `box` comes to lie; nothing where that is not known.
  std::optional<Box3> box_of(const DeformationMaps& maps, const Box3& box) const;
  /// Balls and arrows of the handles there, for pictures of something so large.
  TriangleMesh handle_shapes_at(double share, double size) const;

  /// What it is called in messages.
  const std::string& name() const;
  /// Of handles.
  const MlsDeformationOptions& options() const;
  /// "15 handles, rigid", "by a displacement map"
  std::string words() const;

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

// ---- From files --------------------------------------------------------------------------------------------------

/// One of `handles`, `handles_from` and `map`.
struct SANSMESH_API DeformationInput {
  std::string handles = {};                      ///< file (docs/formats/handles.md)
  std::vector<std::string> handles_from = {};    ///< two files whose vertices correspond: before, after
  std::vector<std::uint32_t> vertices = {};      ///< of these, which are handles
  std::optional<std::size_t> handle_count = {};  ///< instead: so many, far from each other; default: 30
  std::string map = {};                          ///< file of a lattice of displacements
  MlsDeformationOptions by = {};                 ///< of handles
  std::vector<std::string> cuts = {};            ///< each as read_cut reads it

  /// The rows of these options.
  static const OptionSchema& schema();
  /// Throws ArgumentError for what does not go together.
  void validate() const;
};

/// Throws FileError for bad files, ArgumentError for bad options.
SANSMESH_API Deformation read_deformation(const DeformationInput& input, Progress& progress);

// ---- As a map ----------------------------------------------------------------------------------------------------

/// The lattice of a map of displacements.
struct SANSMESH_API DeformationMapOptions {
  std::optional<int> nodes = {};  ///< along the longest side, 2..1024; default: 64
  std::optional<Box3> box = {};   ///< default: around where what is deformed comes to lie

  /// The rows of these options.
  static const OptionSchema& schema();
};

/// The backward map of a deformation as displacements on a lattice.
struct DeformationMapResult {
  GridBlock block;          ///< arrays `displacement` (3 floats) and, where there are gaps, `gap` (1 float)
  FoldReport folds;         ///< of the map in its box
  std::vector<Note> notes;  ///< "folded"
};

/// `before`: the box of what is deformed. Throws ArgumentError for bad options, and where that box has no end;
/// Cancelled.
SANSMESH_API DeformationMapResult deformation_map(const Deformation& deformation, const Box3& before,
                                                  const std::string& name, const DeformationMapOptions& options,
                                                  Progress& progress);

/// Of finite points.
SANSMESH_API Box3 bounds_of(const PointSet& points);

}  // namespace sansmesh::inline v1
