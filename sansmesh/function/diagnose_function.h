// Finds doubtful regions of a fitted function and proposes edits that repair them.
#pragma once

#include "sansmesh/function/edit_function.h"
#include "sansmesh/function_edits.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// The edits are tried together before they are proposed. Those that do not repair their region are reverted (low
/// coverage: no polynomials above degree 1 are left; high error, steep: no such support is left), and harmful ones:
/// after all of them no larger share of the samples is farther from the default mesh than lost_beyond
/// (mesh_coverage.h), up to one in 20,000, which may be lost by remeshing alone. Takes as long as making two meshes, or
/// up to seven if edits are harmful. Throws ArgumentError for invalid options.
Diagnosis diagnose_function(const FittedFunction& function, const DiagnoseOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
