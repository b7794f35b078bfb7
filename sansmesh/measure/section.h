// Cross-sections of surfaces with planes.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/progress.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/solid_measures.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Exact for the mesh. Vertices in the plane count as above it (simulation of simplicity, edelsbrunner1990), so that
/// closed meshes give closed curves, and a face in the plane appears if the solid is below it and not if above: the
/// section is the limit of sections slightly lower. Coincident vertices are joined, so that triangle soups are valid
/// input; triangles with invalid or non-finite corners are ignored. Points are in world coordinates (the mesh's origin
/// added). Linear in the number of triangles, parallel.
Section section_mesh(const TriangleMesh& mesh, const CutPlane& plane);

/// The sections of all planes, computed sequentially.
std::vector<Section> section_mesh(const TriangleMesh& mesh, std::span<const CutPlane> planes, Progress& progress);

struct FieldSectionOptions {
  /// Lattice squares along the longer side of the plane's intersection with the box, 2..4096: smaller features may be
  /// missed, and corners are cut off by at most one square.
  int resolution = 512;
  /// Region; default: the field's own box.
  std::optional<Box3> box = {};
  /// Throws ArgumentError that names the option.
  void validate() const;
};

/// Section of a function, negative inside: evaluates its sign on a lattice of right triangles in the plane and moves
/// every crossing along its lattice edge to the zero set by Newton's method, safeguarded by bisection, to 1e-12 of the
/// edge. Curves never cross each other; they are closed unless they leave the box or the field's domain. Zeros count as
/// outside. The lattice is evaluated in parallel; the result does not depend on the number of threads.
Section section_field(const ScalarField& field, const CutPlane& plane, const FieldSectionOptions& options = {});

std::vector<Section> section_field(const ScalarField& field, std::span<const CutPlane> planes,
                                   const FieldSectionOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
