// Closed meshes of solids with their creases as edges.
#pragma once

#include "sansmesh/csg/solid.h"
#include "sansmesh/field/piecewise_field.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// The surface of a solid. Minima and maxima of smooth functions (PiecewiseField::expression) may have walls of any
/// thickness. Otherwise `solid` must approximate a distance. Below 32 blocks along the box, a block is then not divided
/// if its centre is farther from zero than half its diagonal (one and a half times that if the gradient's norm is not
/// known to be at most 1), or if survey() reports that it need not be (crease_blocks.h). bounds() must be finite unless
/// `options.box` is given, else ArgumentError. Throws DataError if no surface is found, and where parts are too thin to
/// resolve without a `cell`. Deterministic for any number of threads.
TriangleMesh mesh_csg(const PiecewiseField& solid, const CsgMeshOptions& options, Progress& progress,
                      CsgMeshReport* report = nullptr);

/// The box of the solid and of the options, or an ArgumentError or DataError that explains why there is none.
Box3 box_of_solid(const PiecewiseField& solid, const CsgMeshOptions& options);
/// The intersection of a solid and a box, so that cut faces have crease edges.
Solid solid_in_box(const Solid& solid, const Box3& box);
/// Keeps the chosen components and measures the mesh.
void finish_csg(TriangleMesh& mesh, const CsgMeshOptions& options, CsgMeshReport& report);
/// Default mesh error over the box's diagonal.
constexpr double kCsgMeshError = 2e-5;

TriangleMesh mesh_csg(const Solid& solid, const CsgMeshOptions& options, Progress& progress,
                      CsgMeshReport* report = nullptr);

}  // namespace sansmesh::inline v1
