// Cross-sections: the curves in which a plane cuts a surface.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "sansmesh/box.h"
#include "sansmesh/progress.h"
#include "sansmesh/scalar_field.h"
#include "sansmesh/solid_measures.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// Exact for the mesh. Vertices in the plane count as above it (simulation of simplicity, Edelsbrunner and Mücke 1990),
/// so a closed mesh always gives closed curves, and a face that lies in the plane appears if the solid lies below it
/// and not if above: the section is the limit of those by planes a little lower. Vertices at the same place are one, so
/// that triangle soups work; triangles with a corner that is not finite or does not exist are left out. Points in world
/// coordinates (the mesh's origin added). Linear in the number of triangles, parallel.
Section section_mesh(const TriangleMesh& mesh, const CutPlane& plane);

/// One after the other.
std::vector<Section> section_mesh(const TriangleMesh& mesh, std::span<const CutPlane> planes, Progress& progress);

struct FieldSectionOptions {
  /// Squares of the lattice along the longer side of what the plane cuts out of the box, 2..4096: what is smaller than
  /// one may be missed, and corners are cut off by at most one.
  int resolution = 512;
  /// Where to look; default: the field's own box.
  std::optional<Box3> box = {};
  /// Throws ArgumentError saying which.
  void validate() const;
};

/// Straight from a function, negative inside: its sign is taken on a lattice of right triangles in the plane, and every
/// crossing of a lattice edge is moved to the zero set along that edge by Newton's method, safeguarded by bisection, to
/// 1e-12 of the edge. So curves never cross each other; they are closed unless they leave the box or the field's
/// domain. Zeros count as outside. The lattice is evaluated in parallel; the result does not depend on the number of
/// threads.
Section section_field(const ScalarField& field, const CutPlane& plane, const FieldSectionOptions& options = {});

std::vector<Section> section_field(const ScalarField& field, std::span<const CutPlane> planes,
                                   const FieldSectionOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
