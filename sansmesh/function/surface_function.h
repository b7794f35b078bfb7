// A fitted function as an asset: what `.smf` files keep, and what meshing, editing and evaluation start from.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sansmesh/core/progress.h"
#include "sansmesh/data/placement.h"
#include "sansmesh/data/point_set.h"
#include "sansmesh/partition/paper_fit.h"
#include "sansmesh/partition/partition_of_unity.h"
#include "sansmesh/points/prepare_cloud.h"
#include "sansmesh/triangulation/block_tree.h"

namespace sansmesh {

/// Which partition of unity.
enum class FitMethod {
  partition,  ///< our own: docs/methods/partition-of-unity.md
  paper       ///< as the sources have it: docs/methods/paper-partition.md
};

/// How samples become a function. All optional lengths are in the unit of the input; where absent they are derived from
/// the data.
struct FitOptions {
  FitMethod fit = FitMethod::partition;
  /// Of FitMethod::paper: accepted rms distance of a support's samples over the diagonal of all [0.002], and the least
  /// coverage for degrees 2, 3 and 4 [0.4, 0.8, 0.85].
  std::optional<double> threshold;
  std::optional<PaperCoverage> coverage;
  std::optional<int> max_depth;   ///< deepest level of the tree of fits, kLeastDepth..kMostDepth
  std::optional<double> error;    ///< accepted rms error of a local fit (length); default: a tenth of the noise
  std::optional<double> support;  ///< support radius / circumscribed radius of the block, 1.1..2; default 1.5 to 1.8
  int max_degree = 4;             ///< largest degree of the local polynomials, 1..4
  bool sharp = true;              ///< reproduce creases where the data shows them
  /// Whether the surface bounds no solid, and ends where its samples end: true, everywhere, false, nowhere; default:
  /// decided from the data for each connected part.
  std::optional<bool> open;

  /// Throws ArgumentError naming the option, also where one belongs to the other method.
  void validate() const;
  bool is_paper() const { return fit == FitMethod::paper; }
};

/// A partition of unity (METHODS §3.1) with its place in the input and the samples that it was fitted to. Copies share
/// the samples.
struct SurfaceFunction {
  PartitionOfUnity field;  ///< in coordinates of its own, in which the samples are about 1 large
  Placement place;         ///< of these in the input; the unit is a power of two
  /// In the field's coordinates, along the Morton curve of its root cube; never null, but empty where they were not
  /// kept: such a function can be meshed and evaluated, but not refitted.
  std::shared_ptr<const PointSet> samples;
  std::vector<std::string> history;   ///< what was done to it, one line each
  std::vector<std::string> warnings;  ///< of the preparation of the samples; not kept in files
  std::optional<PaperReport> paper;   ///< how the blocks of FitMethod::paper came to be; not kept in files
};

/// The function of samples that are clean and oriented. Throws ArgumentError for bad options.
SurfaceFunction fit_surface_function(PreparedCloud cloud, const FitOptions& options, Progress& progress);

/// The same of samples as they come: they are cleaned and oriented before (prepare_cloud, as it does by itself). Throws
/// DataError where the points cannot be reconstructed (fewer than 9, all coincident, collinear or in a plane).
SurfaceFunction fit_surface_function(PointSet points, const FitOptions& options, Progress& progress);

}  // namespace sansmesh
