// Edits of what was fitted as the sources have it (tejada2008, section 4.4.4). Internal to partition/.
#pragma once

#include <optional>

#include "sansmesh/partition/edit_result.h"
#include "sansmesh/partition/partition_data.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// Whether the samples of a support are too few for a plane, or do not cover as much of it as its degree needs.
bool fails_coverage(const LocalFunction& function, const Support& support, const PaperCoverage& coverage);

/// Polynomials of this degree, or of the highest below it that the samples determine; absent: as the fit chooses. A
/// support with too few samples for a plane stays as it was.
EditResult set_paper_degree(const PartitionData& data, const Selection& chosen, std::optional<int> degree,
                            const EditSamples& samples, Progress& progress);

}  // namespace sansmesh::inline v1
