// Front door to meshes of solids: a field of pieces in, a closed mesh with its creases as edges out.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/csg/solid.h"
#include "sansmesh/field/piecewise_field.h"
#include "sansmesh/mesh_options.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// The surface of a solid. What is minima and maxima of smooth functions (PiecewiseField::expression) has walls of any
/// thickness. Else `solid` is about a distance: blocks whose centre is farther from zero than half their
/// diagonal (one and a half times that if the field's gradients are not known to be 1 at most) are not cut finer, below
/// 32 blocks along the box, nor are those of which its survey() says that they need not be (crease_blocks.h). Its
/// bounds() must be finite, or `options.box` given: else ArgumentError. Throws DataError if no surface is found, and
/// where parts are too thin to be shown without a `cell`. Deterministic for any number of threads.
TriangleMesh mesh_csg(const PiecewiseField& solid, const CsgMeshOptions& options, Progress& progress,
                      CsgMeshReport* report = nullptr);

TriangleMesh mesh_csg(const Solid& solid, const CsgMeshOptions& options, Progress& progress,
                      CsgMeshReport* report = nullptr);

}  // namespace sansmesh::inline v1
