// Edits of functions fitted by the published method (tejada2008, 4.4.4).
#pragma once

#include <optional>

#include "sansmesh/partition/edit/edit_result.h"
#include "sansmesh/partition/partition_data.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// Whether a support has too few samples for a plane, or a lower coverage than its degree requires.
bool fails_coverage(const LocalFunction& function, const Support& support, const PaperCoverage& coverage);

/// Replaces polynomials by those of this degree, or of the highest below it that the samples determine; without a
/// degree, by those of the fit's rule. A support with too few samples for a plane is unchanged.
EditResult set_paper_degree(const PartitionData& data, const Selection& chosen, std::optional<int> degree,
                            const EditSamples& samples, Progress& progress);

}  // namespace sansmesh::inline v1
