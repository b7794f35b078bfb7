// Noise taken off a mesh.
#pragma once

#include <vector>

#include "sansmesh/core/note.h"
#include "sansmesh/core/progress.h"
#include "sansmesh/data/triangle_mesh.h"
#include "sansmesh/mesh/smooth_mesh.h"

namespace sansmesh {

struct SmoothResult {
  TriangleMesh mesh;
  SmoothReport report;
  /// "shortened": `length` would take more rounds than there may be; "moved_far": more than noise is gone.
  std::vector<Note> notes;
};

/// The mesh by Taubin's filter, or with `creases` by bilateral normals (smooth_mesh); its triangles stay. Throws
/// ArgumentError for bad options, Cancelled.
SmoothResult smooth(TriangleMesh mesh, const SmoothOptions& options, Progress& progress);

}  // namespace sansmesh
