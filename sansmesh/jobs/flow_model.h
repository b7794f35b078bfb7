// Errors of a flow that say where it lies.
#pragma once

#include "sansmesh/error.h"
#include "sansmesh/flow.h"

namespace sansmesh::inline v1 {

/// The same error with the flow's source before it and its box behind.
DataError in_flow(const FlowModel& flow, const DataError& error);

}  // namespace sansmesh::inline v1
