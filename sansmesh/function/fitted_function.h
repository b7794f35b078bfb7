// A fitted function with its samples and history, the content of `.smf` files.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/fit_options.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/partition/paper/paper_fit.h"
#include "sansmesh/partition/partition_of_unity.h"
#include "sansmesh/point_set.h"
#include "sansmesh/points/prepare_cloud.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// A partition of unity (tejada2008, 4.4) with its local frame in the input and the samples that it was fitted to.
/// Copies share the samples.
struct FittedFunction {
  PartitionOfUnity field;  ///< in local coordinates, in which the samples are about 1 large
  LocalFrame frame;        ///< local frame in the input; the unit is a power of two
  /// In the field's coordinates, along the Morton curve of its root cube; never null, but empty if they were not kept:
  /// such a function can be meshed and evaluated, but not refitted.
  std::shared_ptr<const PointSet> samples;
  std::vector<std::string> history;  ///< edits applied so far, one line each
  std::vector<Note> notes;           ///< notes on the preparation of the samples; not kept in files
  std::optional<PaperReport> paper;  ///< statistics of the blocks of FitMethod::paper; not kept in files
};

/// Fits a function to clean and oriented samples. Throws ArgumentError for invalid options.
FittedFunction fit_surface_function(PreparedCloud cloud, const FitOptions& options, Progress& progress);

/// The same for raw samples, which are cleaned and oriented first (prepare_cloud with default options). Throws
/// DataError if the points cannot be reconstructed (fewer than 9, all coincident, collinear or in a plane).
FittedFunction fit_surface_function(PointSet points, const FitOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
