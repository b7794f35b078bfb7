// Noise taken off a mesh.
#pragma once

#include <string>
#include <vector>

#include "sansmesh/mesh/smooth_mesh.h"
#include "sansmesh/note.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct SmoothResult {
  TriangleMesh mesh;
  SmoothReport report;
  /// "shortened": `length` would take more rounds than there may be; "moved_far": more than noise is gone.
  std::vector<Note> notes;
};

/// The mesh by Taubin's filter, or with `creases` by bilateral normals (smooth_mesh); its triangles stay. Throws
/// ArgumentError for bad options, Cancelled.
SmoothResult smooth(TriangleMesh mesh, const SmoothOptions& options, Progress& progress);

/// How far vertices moved, and what that did to area and volume, in lines for people.
std::vector<std::string> summary_of(const SmoothReport& report);

}  // namespace sansmesh::inline v1
