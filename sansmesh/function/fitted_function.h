// A fitted function as an asset: what `.smf` files keep, and what meshing, editing and evaluation start from.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/fit_options.h"
#include "sansmesh/local_frame.h"
#include "sansmesh/partition/paper_fit.h"
#include "sansmesh/partition/partition_of_unity.h"
#include "sansmesh/point_set.h"
#include "sansmesh/points/prepare_cloud.h"
#include "sansmesh/progress.h"

namespace sansmesh::inline v1 {

/// A partition of unity (METHODS §3.1) with its place in the input and the samples that it was fitted to. Copies share
/// the samples.
struct FittedFunction {
  PartitionOfUnity field;  ///< in coordinates of its own, in which the samples are about 1 large
  LocalFrame frame;        ///< of these in the input; the unit is a power of two
  /// In the field's coordinates, along the Morton curve of its root cube; never null, but empty where they were not
  /// kept: such a function can be meshed and evaluated, but not refitted.
  std::shared_ptr<const PointSet> samples;
  std::vector<std::string> history;   ///< what was done to it, one line each
  std::vector<std::string> warnings;  ///< of the preparation of the samples; not kept in files
  std::optional<PaperReport> paper;   ///< how the blocks of FitMethod::paper came to be; not kept in files
};

/// The function of samples that are clean and oriented. Throws ArgumentError for bad options.
FittedFunction fit_surface_function(PreparedCloud cloud, const FitOptions& options, Progress& progress);

/// The same of samples as they come: they are cleaned and oriented before (prepare_cloud, as it does by itself). Throws
/// DataError where the points cannot be reconstructed (fewer than 9, all coincident, collinear or in a plane).
FittedFunction fit_surface_function(PointSet points, const FitOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
