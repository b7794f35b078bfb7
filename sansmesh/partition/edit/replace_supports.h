// Last step of every edit.
#pragma once

#include <vector>

#include "sansmesh/partition/edit/edit_result.h"
#include "sansmesh/partition/fit/leaf_fit.h"

namespace sansmesh::inline v1 {

/// Data with the given leaves in place of the chosen supports. Throws DataError if none are left.
EditResult replace_supports(const PartitionData& data, const Selection& chosen, std::vector<FittedLeaf> leaves);

}  // namespace sansmesh::inline v1
