// Connected sheets of a partition of unity, computed from its supports without a mesh.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sansmesh/partition/partition_data.h"
#include "sansmesh/vec.h"

namespace sansmesh::inline v1 {

/// Connected sheets: supports whose blocks touch and whose functions agree on the position of the surface.
struct Sheets {
  std::vector<std::uint32_t> of_support;  ///< 0 has the largest area, and so on; kNone: constants
  std::vector<double> area;               ///< length²
  /// Total area of the samples in the supports' blocks over the area of the sheet: about 1 for a sampled sheet, far
  /// less for one caused by stray samples or by extrapolation.
  std::vector<double> evidence;
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::size_t size() const { return area.size(); }
  /// First of the samples in the block of each support, and number of these; empty without samples.
  std::vector<std::uint32_t> first, count;
};
/// Sheets with less evidence are considered spurious.
constexpr double kLeastEvidence = 0.25;
/// `samples`: in the order of the Morton curve; empty: no evidence (0).
Sheets find_sheets(const PartitionData& data, std::span<const Vec3f> samples);

}  // namespace sansmesh::inline v1
