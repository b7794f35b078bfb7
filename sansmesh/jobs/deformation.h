// A deformation of space with all that it needs: by handles, or by a map of displacements.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/deform/deformation_options.h"
#include "sansmesh/deform/displacement_map.h"
#include "sansmesh/deform/handles.h"
#include "sansmesh/deform/occluder.h"
#include "sansmesh/report.h"
#include "sansmesh/space_map.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Both ways through one deformation.
struct DeformationMaps {
  std::shared_ptr<const SpaceMap> backward;  ///< from places after to places before: fields and volumes are seen by it
  std::shared_ptr<const SpaceMap> forward;   ///< the other way: meshes and clouds are moved by it
};

/// Cheap to copy: what it holds is shared and never changes.
class Deformation {
 public:
  /// By moving least squares. `name` stands in messages: the file of the handles, if there is one. Throws
  /// ArgumentError for bad options, and for handles that cannot be; FileError in its place where there is a name.
  explicit Deformation(std::vector<Handle> handles, const MlsDeformationOptions& options = {},
                       std::vector<std::shared_ptr<const Occluder>> cuts = {}, std::string name = {});
  /// By a backward map, whose inverse is found by Newton's method.
  explicit Deformation(std::shared_ptr<const DisplacementMap> map, std::string name = {});

  /// As far as it has come at a share of the way, 0..1; other than 1 means nothing to a map of displacements.
  DeformationMaps at(double share) const;
  /// The handles there; none of a map.
  std::vector<Handle> handles_at(double share) const;
  bool has_handles() const { return !handles_.empty(); }
  const std::vector<std::shared_ptr<const Occluder>>& cuts() const { return cuts_; }
  /// About where what lies in `box` comes to lie; nothing where that is not known.
  std::optional<Box3> box_of(const DeformationMaps& maps, const Box3& box) const;
  /// Balls and arrows of the handles there, for pictures of something so large.
  TriangleMesh handle_shapes_at(double share, double size) const;

  const std::string& name() const { return name_; }
  /// Of handles.
  const MlsDeformationOptions& options() const { return options_; }
  /// "15 handles, rigid", "by a displacement map"
  std::string words() const;

  static const ReportSchema& schema();

 private:
  std::string name_;
  std::vector<Handle> handles_;
  MlsDeformationOptions options_;
  std::vector<std::shared_ptr<const Occluder>> cuts_;
  DeformationMaps whole_;  ///< at 1
};

/// The box with so much room around it, as a share of its diagonal.
Box3 with_room(const Box3& box, double share);

}  // namespace sansmesh::inline v1
