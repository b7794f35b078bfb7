// Connected sheets of a partition of unity, from its supports alone: no mesh is made.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sansmesh/partition/partition_data.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Connected sheets: supports whose blocks touch and whose functions agree on where the surface runs.
struct Sheets {
  std::vector<std::uint32_t> of_support;  ///< 0 has the largest area, and so on; kNone: constants
  std::vector<double> area;               ///< length²
  /// Samples in the supports' blocks times the area that each stands for, over the area: about 1 for a sheet that was
  /// sampled, far less for one that was made of strays or of nothing.
  std::vector<double> evidence;
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::size_t size() const { return area.size(); }
};
/// With less evidence a sheet is taken to be spurious.
constexpr double kLeastEvidence = 0.25;
/// `samples`: along the Morton curve; empty: no evidence (0).
Sheets find_sheets(const PartitionData& data, std::span<const Vec3f> samples);

}  // namespace sansmesh::inline v1
