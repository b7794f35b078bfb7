// How good a mesh is: by itself, and against a reference.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/mesh/mesh_coverage.h"
#include "sansmesh/mesh/mesh_distance.h"
#include "sansmesh/mesh/mesh_quality.h"
#include "sansmesh/mesh/mesh_topology.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/point_set.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

struct AssessOptions {
  /// On each mesh, 1..2·10⁹. Default: 300000; 5000 of surfaces that differ in size by more than a hundred, where each
  /// costs as much as all triangles.
  std::optional<std::size_t> samples = {};

  static const OptionSchema& schema();
  /// Throws ArgumentError naming the field.
  void validate() const;
};

struct AssessReport {
  std::size_t vertices = 0;              ///< or points
  std::optional<MeshTopology> topology;  ///< of a mesh, sewn where its borders lie on each other
  std::optional<MeshQuality> quality;    ///< of a mesh
  // With a reference.
  std::optional<SurfaceDistance> distance;
  std::optional<MeshCoverage> coverage;  ///< of a mesh whose reference is a cloud or a meshed scan

  static const ReportSchema& schema();
};

struct AssessResult {
  AssessReport report;
  /// "other_unit": mesh and reference differ in size as if they were not in the same unit.
  std::vector<Note> notes;
};

/// Of a mesh, or of points without triangles, by itself. Throws Cancelled.
AssessResult assess(const TriangleMesh& mesh, Progress& progress);

/// The same, and how far it is from the reference and back. Throws ArgumentError for bad options, DataError if a side
/// has no finite points.
AssessResult assess(const TriangleMesh& mesh, PointSet reference, const AssessOptions& options, Progress& progress);

/// All of it in lines for people.
std::vector<std::string> summary_of(const AssessReport& report);

}  // namespace sansmesh::inline v1
