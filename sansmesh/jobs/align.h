// One surface moved onto another.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sansmesh/affine_map.h"
#include "sansmesh/jobs/any_surface.h"
#include "sansmesh/mesh/align_surfaces.h"
#include "sansmesh/note.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

/// The motion and how it fits, in lines for people.
std::vector<std::string> summary_of(const SurfaceAlignment& alignment);

struct AlignResult {
  TriangleMesh moved;  ///< with all that belongs to it; points have no triangles
  /// What it was moved onto: the mesh or the points, of functions and isosurfaces the mesh that was made.
  std::shared_ptr<const TriangleMesh> fixed;
  AffineMap motion;  ///< all of it, `before` included
  SurfaceAlignment report;
  /// "not_unique": other poses fit as well; "free_motions": the surfaces slide on each other; "little_overlap";
  /// "mirrored": the mirror image fits instead; "other_shape": they differ by more than noise; "mesh": what there is to
  /// say of a mesh that was made.
  std::vector<Note> notes;

  static const ReportSchema& schema();
};

/// Finds the motion (align_surfaces) and applies it, after `before`. Throws ArgumentError for bad options, DataError
/// that begins with the name of a surface where it cannot be aligned, or fits nowhere; Cancelled.
AlignResult align(const AnySurface& moving, const AnySurface& fixed, const SurfaceAlignmentOptions& options,
                  Progress& progress, const AffineMap& before = {});

}  // namespace sansmesh::inline v1
