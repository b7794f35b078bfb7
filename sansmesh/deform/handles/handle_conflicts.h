// Detects contradictory handles.
#pragma once

#include <vector>

#include "sansmesh/deform/handles/deform_handle.h"

namespace sansmesh::inline v1::detail {

/// Throws ArgumentError naming two handles (counted from 1) with targets closer than `together` and origins farther
/// apart than `apart`.
void check_handle_conflicts(const std::vector<DeformHandle>& handles, double together, double apart);

}  // namespace sansmesh::inline v1::detail
