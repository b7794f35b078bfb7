// Where a fitted function should not be trusted without a look, and edits that may mend it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/function/edit_function.h"
#include "sansmesh/function_edits.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/triangle_mesh.h"

namespace sansmesh::inline v1 {

/// The edits are tried together before they are proposed, and those taken back that do harm: after all of them no
/// larger share of the samples is farther from the default mesh than lost_beyond (mesh_coverage.h), but for one in
/// 20,000, which making a mesh anew may cost by itself. Takes as long as making two meshes, or up to four where edits
/// do harm. Throws ArgumentError for bad options.
Diagnosis diagnose_function(const FittedFunction& function, const DiagnoseOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
