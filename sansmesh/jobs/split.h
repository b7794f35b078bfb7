// Connected parts of a cloud or a mesh.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "sansmesh/jobs/cloud_or_mesh.h"
#include "sansmesh/note.h"
#include "sansmesh/option.h"
#include "sansmesh/progress.h"
#include "sansmesh/report.h"

namespace sansmesh::inline v1 {

struct SplitOptions {
  /// Of clouds: points as close as this are connected (length, > 0). Default: 4 spacings.
  std::optional<double> split_distance = {};
  std::size_t min_size = 0;         ///< parts of fewer triangles (or points) are left out
  std::size_t most_parts = 10'000;  ///< more are an error

  static const OptionSchema& schema();
  /// Throws ArgumentError.
  void validate() const;
};

struct SplitResult {
  std::vector<CloudOrMesh> parts;  ///< the largest first
  std::size_t found = 0;           ///< those that were left out included
  std::optional<double> distance;  ///< of clouds, as used
  /// "small_parts": parts that were left out; "soup": hardly any triangles share a vertex; "loose_points": vertices of
  /// no triangle were left out.
  std::vector<Note> notes;

  static const ReportSchema& schema();
};

/// Connected parts. Throws ArgumentError for bad options, DataError where none is large enough or there are too many,
/// Cancelled.
SplitResult split(const CloudOrMesh& data, const SplitOptions& options, Progress& progress);

}  // namespace sansmesh::inline v1
