// Adds the position of a flow to its errors.
#pragma once

#include "sansmesh/error.h"
#include "sansmesh/flow.h"

namespace sansmesh::inline v1 {

/// The same error, preceded by the flow's source and followed by its box.
DataError in_flow(const FlowModel& flow, const DataError& error);

}  // namespace sansmesh::inline v1
