// Functions shared by deformations of all kinds of objects.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/deform.h"
#include "sansmesh/image.h"
#include "sansmesh/note.h"
#include "sansmesh/progress.h"
#include "sansmesh/render/surface/picture_surfaces.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Finds folds of space in all poses and keeps the report of the worst pose.
class FoldWatch {
 public:
  /// Searches the bounding box of the object. Returns a mesh that shows the folds, empty if there are none.
  TriangleMesh look(const SpaceMap& map, const Box3& box, Progress& progress);
  const FoldReport& worst() const { return worst_; }
  /// Adds the note "folded" if there are folds.
  void add_note(const std::string& name, std::vector<Note>& notes) const;

 private:
  FoldReport worst_;
};

void add_corners(const Box3& box, std::vector<Vec3>& points);
/// Points whose bounding box contains all poses: of the first, the middle and the last.
std::vector<Vec3> points_of_poses(const Deformation& deformation, const Box3& before, const DeformOptions& options,
                                  bool unknown_as_before);
/// Draws surfaces, with handles and folds if requested; `framed` and the handles determine the frame.
Image picture_of_pose(std::vector<SceneFactory> surfaces, const DeformOptions& options, const Deformation& deformation,
                      double share, std::vector<Vec3> framed, const TriangleMesh& folds, Progress& progress);

}  // namespace sansmesh::inline v1
