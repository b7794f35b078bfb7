// Parts that deformations of all kinds of things share.
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

/// Looks where space is folded, and keeps of all poses the one that is folded most.
class FoldWatch {
 public:
  /// In a box: that of what is seen through the map, or of what is moved by it. Returns the folds as something to see,
  /// which is empty where there are none.
  TriangleMesh look(const SpaceMap& map, const Box3& box, Progress& progress);
  const FoldReport& worst() const { return worst_; }
  /// "folded", if anything is.
  void add_note(const std::string& name, std::vector<Note>& notes) const;

 private:
  FoldReport worst_;
};

/// The box with so much room around it, as a share of its diagonal.
Box3 with_room(const Box3& box, double share);
void add_corners(const Box3& box, std::vector<Vec3>& places);
void add_vertices(const TriangleMesh& mesh, std::vector<Vec3>& places);
/// Places that all poses lie within, where there are several: of the first, the middle and the last.
std::vector<Vec3> places_of_poses(const Deformation& deformation, const Box3& before, const DeformOptions& options,
                                  bool unknown_as_before);
/// Surfaces, and beside them handles and folds as far as they are asked for, framed by `places` and the handles.
Image picture_of_pose(std::vector<PictureSurface> surfaces, const DeformOptions& options,
                      const Deformation& deformation, double share, std::vector<Vec3> places, const TriangleMesh& folds,
                      Progress& progress);

}  // namespace sansmesh::inline v1
